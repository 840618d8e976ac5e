// The page: loads the FMUs into workers, keeps the parameters, and lets the views compute and draw.

import { Controls } from "./controls.mjs";
import { readDescription } from "./description.mjs";
import { checked, parameterOf, readMeasured, readSsv, writeCsv, writeSsv } from "./files.mjs";
import { FrfView } from "./frf_view.mjs";
import { LineView } from "./line_view.mjs";
import { Pool } from "./pool.mjs";
import { SlipView } from "./slip_view.mjs";
import { StaticView } from "./static_view.mjs";

const REST = 350; // ms after which a figure is refined
const ACCURATE_STEP = 5e-4; // s, as the commands take it: the FMU's own is off by 7 % near 12 Hz
const at = (id) => document.getElementById(id);
const data = JSON.parse(at("data").textContent);

async function unpacked(base64) {
  const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

function tell(message) {
  at("message").hidden = !message;
  at("message").textContent = message;
}

function download(name, content, type) {
  const url = content.startsWith?.("data:") ? content : URL.createObjectURL(new Blob([content], { type }));
  Object.assign(document.createElement("a"), { href: url, download: name }).click();
}

const models = {};
for (const [model, { module, description }] of Object.entries(data.models))
  models[model] = { bytes: await unpacked(module), description };
const pantograph = readDescription(models.ZSpringPantograph.description);
const catenary = readDescription(models.Catenary.description);
const pool = new Pool(at("worker").textContent, models, Math.max(1, Math.min(4, (navigator.hardwareConcurrency || 2) - 1)));

const head = () => ({
  FMU: `${pantograph.model} ${pantograph.version}`,
  GUID: pantograph.guid,
  ...(controls.synthetic.length ? { synthetic: controls.synthetic.join(" ") } : {}),
  ...controls.parameters,
});
/** A table of what a view shows, under the head of the parameters that it was made with. */
const save = ({ made }, file, titles, rows) => {
  if (!made) return tell(`${file}: there is nothing to save yet`);
  download(file, writeCsv(made, titles, rows), "text/csv");
};
const context = { pool, pantograph, catenary, lines: data.lines, tell, head, save, readSsv, parameters: () => controls.parameters };

let rest = 0;
const controls = new Controls(pantograph, { "solver.step": ACCURATE_STEP }, changed, tell);
const views = { frf: new FrfView(context), static: new StaticView(context), line: new LineView(context), slip: new SlipView(context) };
let shown = "frf";

function commandLine() {
  const parts = Object.entries(controls.values).map(([name, value]) => ` --set ${name}=${value}`).join("");
  const [first, last] = ["first-span", "last-span"].map((id) => at(id).value);
  const journey = `--speed ${at("speed").value} --uplift ${at("uplift").value} --spans ${first}:${last}`;
  return `zspring frf${parts}\nzspring couple --line ${at("line-set").value} ${journey}${parts}`;
}

async function changed(live) {
  clearTimeout(rest);
  const given = Object.entries(controls.values).map(([name, value]) => `${name}=${encodeURIComponent(value)}`);
  if (!live) history.replaceState(null, "", `#${given.join("&")}`);
  at("command").value = commandLine();
  const synthetic = controls.synthetic;
  at("synthetic").hidden = !synthetic.length;
  at("synthetic").textContent = `Synthetic, nobody measured them: ${synthetic.join(", ")}`;
  tell("");
  if (live) views[shown].update(true);
  rest = setTimeout(() => views[shown].update(false), live ? REST : 0);
}

function show(name) {
  shown = name;
  for (const view of Object.keys(views)) {
    at(view).hidden = view !== name;
    at(`tab-${view}`).setAttribute("aria-selected", String(view === name));
    at(`tab-${view}`).tabIndex = view === name ? 0 : -1;
  }
  views[name].update(false);
}

function fromFragment() {
  const values = {};
  for (const part of location.hash.slice(1).split("&").filter(Boolean)) {
    const [name, text] = part.split("=");
    values[name] = checked(parameterOf(pantograph, name), decodeURIComponent(text ?? ""));
  }
  return values;
}

async function take(file) {
  try {
    const text = await file.text();
    if (/\.csv$/i.test(file.name)) {
      const measured = readMeasured(text);
      show("frf");
      views.frf.measured = measured;
      views.frf.draw();
      tell("");
    } else controls.replace(readSsv(text, pantograph));
  } catch (error) {
    tell(`${file.name}: ${error.message}`);
  }
}

at("about").textContent = `${pantograph.model} ${pantograph.version} ${pantograph.guid}, the FMUs themselves, in this page. Nothing leaves it.`;
at("set").append(new Option("start values of the FMU", ""), ...Object.keys(data.sets).map((name) => new Option(name)));
at("set").onchange = () => controls.replace(at("set").value ? readSsv(data.sets[at("set").value], pantograph) : {});
at("reset").onclick = () => {
  at("set").value = "";
  controls.replace({});
};
at("pin").onclick = () => views[shown].pin?.();
at("unpin").onclick = () => views[shown].unpin?.();
at("save").onclick = () => {
  const all = [...pantograph.variables.values()].filter(({ name, causality }) => causality === "parameter" && !/^(drive$|bench\.)/.test(name));
  const values = Object.fromEntries(all.map(({ name }) => [name, controls.get(name)]));
  download("pantograph.ssv", writeSsv(values, pantograph, "explored"), "application/xml");
};
at("open").onchange = async () => {
  for (const file of at("open").files) await take(file);
  at("open").value = "";
};
document.addEventListener("dragover", (event) => event.preventDefault());
document.addEventListener("drop", async (event) => {
  event.preventDefault();
  for (const file of event.dataTransfer.files) await take(file);
});
for (const name of Object.keys(views)) {
  at(`tab-${name}`).onclick = () => show(name);
  at(`tab-${name}`).onkeydown = ({ key }) => {
    const names = Object.keys(views), by = { ArrowRight: 1, ArrowLeft: -1 }[key];
    if (!by) return;
    show(names[(names.indexOf(name) + by + names.length) % names.length]);
    at(`tab-${shown}`).focus();
  };
}
for (const button of document.querySelectorAll("[data-png]"))
  button.onclick = () => {
    const source = at(button.dataset.png), copy = document.createElement("canvas");
    const note = Math.round(18 * (source.width / source.clientWidth));
    Object.assign(copy, { width: source.width, height: source.height + 2 * note });
    const c = copy.getContext("2d");
    c.fillStyle = "#fff";
    c.fillRect(0, 0, copy.width, copy.height);
    c.drawImage(source, 0, 0);
    c.fillStyle = "#444";
    c.font = `${Math.round(0.6 * note)}px sans-serif`;
    const view = views[button.closest("section").id], made = source.id === "sweep-plot" ? view.swept?.made : view.made;
    const { FMU, GUID, synthetic, ...settings } = made ?? head();
    c.fillText(`${FMU} ${GUID}${synthetic ? ", Z-spring parameters synthetic" : ""}`, 8, source.height + note * 0.8);
    c.fillText(Object.entries(settings).map(([name, value]) => `${name}=${value}`).join(" "), 8, source.height + note * 1.6);
    download(`${button.dataset.png}.png`, copy.toDataURL("image/png"));
  };

try {
  await pool.ready;
  controls.replace(fromFragment());
} catch (error) {
  controls.replace({});
  tell(error.message);
}
for (const id of ["line-set", "speed", "uplift", "first-span", "last-span"])
  at(id).addEventListener("change", () => (at("command").value = commandLine()));
window.onhashchange = () => {
  try {
    controls.replace(fromFragment());
  } catch (error) {
    tell(error.message);
  }
};
document.documentElement.dataset.ready = "true";
