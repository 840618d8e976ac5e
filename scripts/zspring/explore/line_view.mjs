// Under the line: the wire in motion, the contact force and its statistics, other heads beside it.

import { drawLine } from "./draw.mjs";
import { lowPass, statistics } from "./filter.mjs";
import { DASHES, pale, Plot } from "./plot.mjs";
import { SweepView } from "./sweep_view.mjs";
import { fill } from "./tables.mjs";

const STEP = 1e-3; // s, communication step
const BAND = 20; // Hz
const SMALL = 0.2; // m, as zspring/line/limits.py has it
const RUN_OUT = 0.4; // s behind the evaluated spans, for the filter
const HEADS = [["as set", {}, "#12395b", "solid"], ["locked", { suspension: "LinearLocked" }, "#c60", "dashed"], ["free", { suspension: "LinearFree" }, "#2a788e", "dotted"]];
const FIELDS = { speed: "speed", uplift: "uplift", "first-span": "first span", "last-span": "last span" };
const at = (id) => document.getElementById(id);

export class LineView {
  constructor(context) {
    Object.assign(this, { context, results: [], pinned: null, version: 0, frame: 0, playing: true });
    this.setLines();
    this.force = new Plot(at("force-plot"), { x: "place along the line  [m]", y: "contact force, 0 to 20 Hz  [N]" });
    this.sweep = new SweepView(this, context);
    at("run").onclick = () => this.run();
    for (const id of ["line-set", "compare", ...Object.keys(FIELDS)]) at(id).onchange = () => context.changed();
    at("place").oninput = () => {
      this.play(false);
      this.show(Number(at("place").value));
    };
    at("play").onclick = () => this.play(!this.playing);
    at("line-csv").onclick = () => this.save();
    const move = () => {
      if (this.playing && this.frames && at("wire").offsetParent) {
        if (this.frame + 1 < this.frames.length) this.show(this.frame + 1);
        else this.play(false);
      }
      setTimeout(move, 40);
    };
    move();
    new ResizeObserver(() => this.frames && this.show(this.frame)).observe(at("wire"));
  }

  /** The lines to choose from, and the one that is chosen. */
  setLines(chosen) {
    at("line-set").replaceChildren(...Object.keys(this.context.lines).map((name) => new Option(name)));
    if (chosen) at("line-set").value = chosen;
  }

  /** A run takes about a second: it waits until the parameters rest. */
  update(live) {
    if (!live) return this.run();
    this.context.stale("line", true);
    this.context.stale("sweep-result", true);
    at("line-state").textContent = "runs once the parameters rest";
  }

  /** What the fields ask for; null, and told, where they are wrong. */
  asked(speed) {
    const { context } = this, { tell, catenary } = context;
    for (const [id, what] of Object.entries(FIELDS))
      if (!at(id).checkValidity() || !Number.isFinite(at(id).valueAsNumber)) return tell(`${what} = ${at(id).value || "nothing"}: must be ${at(id).step === "1" ? "a whole number" : "a number"}, ${at(id).max ? `in ${at(id).min} .. ${at(id).max}` : `at least ${at(id).min}`}`);
    const line = context.readSsv(context.lines[at("line-set").value], catenary);
    const of = (name) => line[name] ?? catenary.variables.get(name).start;
    const spans = of("line.spans"), span = of("line.span"), first = at("first-span").valueAsNumber, last = at("last-span").valueAsNumber;
    if (!(first >= 2 && first <= last && last < spans)) return tell(`spans ${first} to ${last}: must be in 2 .. ${spans - 1}, not the first nor the last of the line`);
    const v = (speed ?? at("speed").valueAsNumber) / 3.6, start = span / 2;
    const wave = Math.max(...["contact_wire", "messenger"].map((wire) => Math.sqrt(of(`${wire}.tension`) / of(`${wire}.mass`))));
    const undisturbed = start + (v * 2 * (spans * span - start)) / (wave + v);
    return {
      begin: (first - 1) * span, end: last * span, span, spans, undisturbed,
      doubts: [
        ...(first - 1 < 1.5 ? [`the start takes until ${1.5 * span} m: take later spans`] : []),
        ...(last * span > undisturbed ? [`from ${Math.round(undisturbed)} m on the far end reflects the waves of the start: take earlier spans`] : []),
      ],
      stop: Math.min(last * span + RUN_OUT * v, (spans - 0.5) * span),
      run: { line, speed: v, step: STEP, start, runUp: span, length: spans * span, uplift: at("uplift").valueAsNumber },
    };
  }

  /** A run with settings of `asked`. */
  async of(settings, own, frames, kind, progress) {
    const pantograph = { ...this.context.parameters(), ...own };
    const told = await this.context.pool.run(kind, "line", { run: { ...settings.run, pantograph }, stop: settings.stop, frames }, progress);
    const inside = (i) => told.positions[i] >= settings.begin - 1e-7 && told.positions[i] <= settings.end + 1e-7;
    return { ...told, statistics: statistics(told.forces, STEP, inside) };
  }

  /** The heads that are compared: [name, parameters, color, dash]. */
  get heads() {
    return HEADS.slice(0, at("compare").checked && this.context.parameters().suspension !== "Linear" ? 3 : 1);
  }

  async run() {
    const version = ++this.version, { tell, pool, stale } = this.context, made = this.head(), { heads } = this;
    stale("line", true);
    pool.drop("line");
    this.sweep.check(made);
    const settings = this.asked();
    if (!settings) return void (at("line-state").textContent = this.results.length ? "what is below is another run" : "");
    const progress = ({ position }) => version === this.version && (at("line-state").textContent = `at ${Math.round(position)} of ${Math.round(settings.stop)} m`);
    at("line-state").textContent = "running";
    try {
      const results = await Promise.all(heads.map(([, own], i) => this.of(settings, own, i === 0, "line", progress)));
      if (version !== this.version) return;
      Object.assign(this, { results, settings, frames: results[0].frames, shownHeads: heads, made });
      stale("line", false);
      const lifted = Math.max(...results.map((result) => result.lifted));
      const doubts = [...settings.doubts, ...(lifted > SMALL ? [`uplift of ${(1e3 * lifted).toPrecision(3)} mm at a support: the line's model is for up to ${1e3 * SMALL} mm`] : [])];
      at("line-state").textContent = doubts.length ? `Do not rely on the statistics: ${doubts.join("; ")}` : "";
      at("place").max = this.frames.length - 1;
      at("place").disabled = at("play").disabled = false;
      this.draw();
      this.show(Math.min(this.frame, this.frames.length - 1));
      this.play(this.playing);
    } catch (error) {
      if (version !== this.version) return;
      tell(error.message);
      at("line-state").textContent = this.results.length ? "what is below is another run" : "";
    }
  }

  draw() {
    const { settings, pinned } = this;
    if (!settings) return;
    const curves = this.results.map(({ positions, forces }, i) => {
      const [name, , color, dash] = this.shownHeads[i];
      return { x: positions, y: lowPass(forces, STEP, BAND), color, dash: DASHES[dash], label: name };
    });
    this.force.show([...(pinned?.curves ?? []), ...curves]);
    at("statistics").caption.textContent = `0 to 20 Hz, spans from ${settings.begin} to ${settings.end} m; loss of contact of the unfiltered force`;
    const row = (name, s) => [name, ...[s.mean, s.deviation, s.maximum, s.minimum, s.lost].map((value) => value.toFixed(1))];
    const rows = this.results.map((result, i) => row(this.shownHeads[i][0], result.statistics));
    if (pinned) rows.push(row(`pinned, its spans: ${pinned.what}`, pinned.statistics));
    fill(at("statistics"), [["head", "mean, N", "standard deviation, N", "maximum, N", "minimum, N", "contact lost, %"], ...rows]);
    this.curves = curves;
  }

  /** Keeps the run of the head as it is set. */
  pin(what) {
    if (!this.settings) return;
    const { line, speed, uplift } = this.made, told = `${what}; ${line}, ${speed}, uplift ${uplift}`;
    this.sweep.pin(what);
    this.pinned = { what: told, curves: pale(this.curves.slice(0, 1), told), statistics: this.results[0].statistics };
    this.draw();
  }

  unpin() {
    this.pinned = null;
    this.sweep.pin(null);
    this.draw();
  }

  show(frame) {
    this.frame = frame;
    at("place").value = frame;
    const { row, ...shape } = this.frames[frame], position = this.results[0].positions[row];
    at("place").setAttribute("aria-valuetext", `${Math.round(position)} m`);
    const supports = Array.from({ length: this.settings.spans - 1 }, (_, i) => (i + 1) * this.settings.span);
    drawLine(at("wire"), shape, position, supports);
  }

  play(on) {
    this.playing = on;
    at("play").textContent = on ? "Pause" : "Play";
    if (on && this.frame + 1 >= this.frames.length) this.frame = 0;
  }

  /** What a run or a sweep is made with. */
  head() {
    const { catenary } = this.context, [first, last] = ["first-span", "last-span"].map((id) => at(id).value);
    return {
      ...this.context.head(),
      line: at("line-set").value,
      "line FMU": `${catenary.model} ${catenary.version} ${catenary.guid}`,
      speed: `${at("speed").value} km/h`,
      uplift: `${at("uplift").value} N on upper_frame`,
      spans: `${first} to ${last}`,
    };
  }

  save() {
    const titles = ["position [m]", ...(this.shownHeads ?? []).map(([name]) => `contact force ${name} [N]`)];
    const rows = (this.results[0]?.positions ?? []).map((x, i) => [x, ...this.results.map(({ forces }) => forces[i])]);
    this.context.save(this, "line.csv", titles, rows);
  }
}
