// The page: loads the FMUs into workers, keeps the parameters, and lets the views compute and draw.

import { Controls, SET_BY_VIEWS } from "./controls.mjs";
import { readDescription } from "./description.mjs";
import { checked, parameterOf, readSsv, writeCsv, writeSsv } from "./files.mjs";
import { FrfView } from "./frf_view.mjs";
import { LineView } from "./line_view.mjs";
import { decoded, otherThan, readMeasured } from "./measured.mjs";
import { Pool } from "./pool.mjs";
import { SlipView } from "./slip_view.mjs";
import { StaticView } from "./static_view.mjs";

const REST = 350; // ms after which a figure is refined
const ACCURATE_STEP = 5e-4; // s, as the commands take it: the FMU's own is off by 7 % near 12 Hz
const FIELDS = ["amplitudes", "low", "high", "frf-shows", "point-amplitude", "point-frequency", "rate", "line-set", "speed", "uplift", "first-span", "last-span"]; // of views, kept in the address
const OWN = "own values"; // no packaged set
const at = (id) => document.getElementById(id);
const data = JSON.parse(at("data").textContent);

async function unpacked(base64) {
  const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
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
/** What is shown of this id is not, or is again, of the parameters as they are. */
const stale = (id, on) => {
  at(id).classList.toggle("stale", on);
  at(id).setAttribute("aria-busy", String(on));
};
const context = { pool, pantograph, catenary, lines: data.lines, tell, head, save, stale, readSsv, parameters: () => controls.parameters, changed: () => changed(false), kept: () => history.replaceState(null, "", address()) };

let rest = 0;
const own = {}; // lines from files
const controls = new Controls(pantograph, { "solver.step": ACCURATE_STEP }, changed, tell);
const views = { frf: new FrfView(context), static: new StaticView(context), line: new LineView(context), slip: new SlipView(context) };
let shown = "frf";

/** The name of the set that has these values that differ from the start values. */
function setOf(values) {
  const text = (some) => JSON.stringify(Object.entries(some).sort());
  return [...sets].find(([, some]) => text(some) === text(values))?.[0] ?? OWN;
}

/** The parameters that differ from the start values. */
const changes = () => Object.entries(controls.values).map(([name, value]) => `${name}=${value}`);

function commandLine() {
  const quoted = (text) => (/^[-\w.:,=/]+$/.test(text) ? text : `"${text}"`);
  const parts = changes().map((part) => ` --set ${part}`).join("");
  const [first, last] = ["first-span", "last-span"].map((id) => at(id).value);
  const journey = `--speed ${at("speed").value} --uplift ${at("uplift").value} --spans ${first}:${last}`;
  const amplitudes = at("amplitudes").value.split(/[;,\s]+/).filter(Boolean).join(",");
  return `zspring frf --amplitudes ${amplitudes} --frequencies ${at("low").value}:${at("high").value}:0.125${parts}\nzspring couple --line ${quoted(at("line-set").value)} ${journey}${parts}`;
}

function address() {
  const fields = FIELDS.filter((id) => at(id).value !== initial[id] && !(id === "line-set" && at(id).value in own)).map((id) => [`page.${id}`, at(id).value]);
  const all = [...(shown === "frf" ? [] : [["page.view", shown]]), ...fields, ...Object.entries(controls.values)];
  return `#${all.map(([name, value]) => `${name}=${encodeURIComponent(value)}`).join("&")}`;
}

function changed(live) {
  clearTimeout(rest);
  if (!live) history.replaceState(null, "", address());
  at("command").value = commandLine();
  at("set").value = setOf(controls.values);
  const synthetic = controls.synthetic;
  at("synthetic").hidden = !synthetic.length;
  at("synthetic").textContent = `Synthetic, nobody measured them: ${synthetic.join(", ")}`;
  tell("");
  if (live) views[shown].update(true);
  else stale(shown, true);
  rest = setTimeout(() => views[shown].update(false), live ? REST : 0);
}

function show(name) {
  shown = name;
  for (const view of Object.keys(views)) {
    at(view).hidden = view !== name;
    at(`tab-${view}`).setAttribute("aria-selected", String(view === name));
    at(`tab-${view}`).tabIndex = view === name ? 0 : -1;
  }
  changed(false);
}

/** Parameters, fields and view from the address. Throws Error, and changes nothing then. */
function fromFragment() {
  const values = {}, fields = {};
  let view = "frf";
  for (const part of location.hash.slice(1).split("&").filter(Boolean)) {
    const [name, coded = ""] = part.split("="), text = decodeURIComponent(coded);
    if (name === "page.view" && text in views) view = text;
    else if (FIELDS.includes(name.replace("page.", "")) && name.startsWith("page.")) fields[name.slice(5)] = text;
    else if (SET_BY_VIEWS.test(name)) throw new Error(`${name}: is set by the views`);
    else values[name] = checked(parameterOf(pantograph, name), text);
  }
  for (const id of FIELDS) at(id).value = fields[id] ?? initial[id];
  for (const id of ["line-set", "frf-shows"]) if (!at(id).value) at(id).selectedIndex = 0;
  controls.replace(values);
  show(view);
}

async function take(file) {
  try {
    const text = decoded(new Uint8Array(await file.arrayBuffer()));
    if (/\.(csv|txt|tsv)$/i.test(file.name)) {
      views.frf.show(readMeasured(text), file.name, () => otherThan(text, { static_force: controls.get("static_force"), friction: controls.get("friction") }));
      show("frf");
    } else if (isOfLine(text)) {
      own[file.name] = text;
      Object.assign(data.lines, { [file.name]: text });
      views.line.setLines(file.name);
      show("line");
    } else {
      const values = readSsv(text, pantograph), ignored = Object.keys(values).filter((name) => SET_BY_VIEWS.test(name));
      controls.replace(values);
      if (ignored.length) tell(`${file.name}: ${ignored.join(", ")}: not taken, the views set them`);
    }
  } catch (error) {
    tell(`${file.name}: ${error.message}`);
  }
}

/** Whether a set is of the line, which it is by its first parameter. Throws Error for a broken one of the line. */
function isOfLine(text) {
  const name = text.match(/Parameter\s+name="([^"]*)"/)?.[1];
  return catenary.variables.has(name) && !pantograph.variables.has(name) && !!readSsv(text, catenary);
}

at("about").textContent = `${pantograph.model} and ${catenary.model} ${pantograph.version}, the FMUs themselves, in this page. Nothing leaves it.`;
const sets = new Map([["", {}], ...Object.entries(data.sets).map(([name, text]) => [name, controls.apart(readSsv(text, pantograph))])]);
at("set").append(new Option("start values of the FMU", ""), ...Object.keys(data.sets).map((name) => new Option(name)), new Option("own values", OWN));
at("set").options[sets.size].disabled = true;
at("set").onchange = () => controls.replace(sets.get(at("set").value));
at("skip").onclick = () => at(`tab-${shown}`).focus(); // past all parameters, by keyboard
at("reset").onclick = () => controls.replace({});
at("pin").onclick = () => {
  if (at(shown).classList.contains("stale")) return tell("Pin: wait until the curves are those of the parameters");
  views[shown].pin(changes().join(" ") || "start values");
};
at("unpin").onclick = () => views[shown].unpin();
at("unmeasure").onclick = () => views.frf.show([]);
at("save").onclick = () => {
  const all = [...pantograph.variables.values()].filter(({ name, causality }) => causality === "parameter" && !SET_BY_VIEWS.test(name));
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
    const view = views[button.closest("section").id], made = source.id === "sweep-plot" ? view.sweep.swept?.made : view.made;
    const { FMU, GUID, synthetic, ...settings } = made ?? head();
    c.fillText(`${FMU} ${GUID}${synthetic ? ", Z-spring parameters synthetic" : ""}`, 8, source.height + note * 0.8);
    c.fillText(Object.entries(settings).map(([name, value]) => `${name}=${value}`).join(" "), 8, source.height + note * 1.6);
    download(`${button.dataset.png}.png`, copy.toDataURL("image/png"));
  };

const restore = () => {
  try {
    fromFragment();
  } catch (error) {
    controls.replace({});
    show(shown);
    tell(`address: ${error.message}`);
  }
};
const initial = Object.fromEntries(FIELDS.map((id) => [id, at(id).value]));
window.onhashchange = restore;
try {
  await pool.ready;
  restore();
} catch (error) {
  tell(`The FMUs cannot run here: ${error.message}`);
}
document.documentElement.dataset.ready = "true";
