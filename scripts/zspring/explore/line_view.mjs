// Under the line: the wire in motion, the contact force and its statistics, other heads beside it, and over speeds.

import { drawLine } from "./draw.mjs";
import { lowPass, statistics } from "./filter.mjs";
import { fill } from "./frf_view.mjs";
import { DASHES, Plot } from "./plot.mjs";

const STEP = 1e-3; // s, communication step
const BAND = 20; // Hz
const RUN_OUT = 0.4; // s behind the evaluated spans, for the filter
const SPEEDS = [160, 180, 200, 220, 240, 250, 260, 280, 300, 320, 350]; // km/h
const HEADS = [["as set", {}, "#12395b", "solid"], ["locked", { suspension: "LinearLocked" }, "#c60", "dashed"], ["free", { suspension: "LinearFree" }, "#2a788e", "dotted"]];
const FIELDS = { speed: "speed", uplift: "uplift", "first-span": "first span", "last-span": "last span" };
const at = (id) => document.getElementById(id);

export class LineView {
  constructor(context) {
    Object.assign(this, { context, results: [], version: 0, frame: 0, playing: false });
    at("line-set").append(...Object.keys(context.lines).map((name) => new Option(name)));
    this.force = new Plot(at("force-plot"), { x: "place along the line  [m]", y: "contact force, 0 to 20 Hz  [N]" });
    this.sweepPlot = new Plot(at("sweep-plot"), { x: "speed  [km/h]", y: "standard deviation, 0 to 20 Hz  [N]", legend: "left" });
    at("run").onclick = () => this.run();
    at("sweep").onclick = () => this.sweep();
    for (const id of ["line-set", "speed", "uplift", "first-span", "last-span"]) at(id).onchange = () => this.stale();
    at("place").oninput = () => this.show(Number(at("place").value));
    at("play").onclick = () => this.play(!this.playing);
    at("line-csv").onclick = () => this.save();
    at("sweep-csv").onclick = () => this.saveSweep();
    const move = () => {
      if (this.playing && this.frames) {
        if (this.frame + 1 < this.frames.length) this.show(this.frame + 1);
        else this.play(false);
      }
      setTimeout(move, 40);
    };
    move();
  }

  /** Parameters that changed do not run the line: that takes seconds; the result says that it is of others. */
  update(live) {
    this.stale();
  }

  stale() {
    if (this.results.length) at("line-state").textContent = "settings have changed since this run";
    else at("line-state").textContent = "Run takes some seconds; parameters on the left apply";
  }

  /** What the fields ask for; null, and told, where they are wrong. */
  asked(speed) {
    const { context } = this, { tell, catenary } = context;
    for (const [id, what] of Object.entries(FIELDS))
      if (!at(id).checkValidity() || !Number.isFinite(at(id).valueAsNumber)) return tell(`${what} = ${at(id).value}: ${at(id).validationMessage || "must be a number"}`);
    const line = context.readSsv(context.lines[at("line-set").value], catenary);
    const of = (name) => line[name] ?? catenary.variables.get(name).start;
    const spans = of("line.spans"), span = of("line.span"), first = at("first-span").valueAsNumber, last = at("last-span").valueAsNumber;
    if (!(first >= 2 && first <= last && last < spans)) return tell(`spans ${first} to ${last}: must be in 2 .. ${spans - 1}, behind the start and before the end of the line`);
    const v = (speed ?? at("speed").valueAsNumber) / 3.6, start = span / 2;
    const wave = Math.max(...["contact_wire", "messenger"].map((wire) => Math.sqrt(of(`${wire}.tension`) / of(`${wire}.mass`))));
    const undisturbed = start + (v * 2 * (spans * span - start)) / (wave + v);
    return {
      begin: (first - 1) * span, end: last * span, span, spans, undisturbed,
      stop: Math.min(last * span + RUN_OUT * v, (spans - 0.5) * span),
      run: { line, speed: v, step: STEP, start, runUp: span, length: spans * span, uplift: at("uplift").valueAsNumber },
    };
  }

  async of(settings, own, frames, progress) {
    const pantograph = { ...this.context.parameters(), ...own };
    const told = await this.context.pool.run("line", "line", { run: { ...settings.run, pantograph }, stop: settings.stop, frames }, progress);
    const inside = (i) => told.positions[i] >= settings.begin - 1e-7 && told.positions[i] <= settings.end + 1e-7;
    return { ...told, statistics: statistics(told.forces, STEP, inside) };
  }

  async run() {
    const settings = this.asked();
    if (!settings) return;
    const version = ++this.version, { tell, pool } = this.context, made = this.head();
    pool.drop("line");
    tell("");
    const heads = HEADS.slice(0, at("compare").checked && this.context.parameters().suspension !== "Linear" ? 3 : 1);
    const progress = ({ position }) => version === this.version && (at("line-state").textContent = `at ${Math.round(position)} of ${Math.round(settings.stop)} m`);
    at("line-state").textContent = "running";
    try {
      const results = await Promise.all(heads.map(([, own], i) => this.of(settings, own, i === 0, progress)));
      if (version !== this.version) return;
      Object.assign(this, { results, settings, frames: results[0].frames, heads, made });
      this.draw();
      at("line-state").textContent = settings.end > settings.undisturbed ? `beyond ${Math.round(settings.undisturbed)} m the line's far end reflects the waves of the start: take earlier spans` : "done";
      at("place").max = this.frames.length - 1;
      at("place").disabled = at("play").disabled = false;
      this.show(0);
      this.play(true);
    } catch (error) {
      if (version !== this.version) return;
      tell(error.message);
      at("line-state").textContent = "";
    }
  }

  draw() {
    const { settings } = this;
    const curves = this.results.map(({ positions, forces }, i) => {
      const [name, , color, dash] = this.heads[i];
      return { x: positions, y: lowPass(forces, STEP, BAND), color, dash: DASHES[dash], label: name };
    });
    this.force.show(curves);
    const caption = at("statistics").caption;
    caption.textContent = `0 to 20 Hz, spans from ${settings.begin} to ${settings.end} m; loss of contact of the unfiltered force`;
    const rows = this.results.map(({ statistics: s }, i) => [this.heads[i][0], ...[s.mean, s.deviation, s.maximum, s.minimum, s.lost].map((value) => value.toFixed(1))]);
    fill(at("statistics"), [["head", "mean, N", "standard deviation, N", "maximum, N", "minimum, N", "contact lost, %"], ...rows]);
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

  async sweep() {
    const all = SPEEDS.map((speed) => [speed, this.asked(speed)]);
    if (all.some(([, settings]) => !settings)) return;
    const version = ++this.version, { tell, pool } = this.context, found = HEADS.map(() => new Map());
    const { speed: _, ...made } = this.head();
    pool.drop("line");
    at("sweep-result").hidden = false;
    at("line-state").textContent = "sweeping";
    try {
      await Promise.all(
        all.flatMap(([speed, settings]) =>
          HEADS.map(async ([, own], i) => {
            const { statistics: told } = await this.of(settings, own, false);
            if (version !== this.version) return;
            found[i].set(speed, told.deviation);
            this.swept = { made, found };
            this.sweepPlot.show(HEADS.map(([name, , color, dash], k) => {
              const speeds = SPEEDS.filter((one) => found[k].has(one));
              return { x: speeds, y: speeds.map((one) => found[k].get(one)), color, dash: DASHES[dash], label: name };
            }));
            at("line-state").textContent = `sweep: ${found.reduce((n, some) => n + some.size, 0)} of ${HEADS.length * SPEEDS.length} runs`;
          }),
        ),
      );
    } catch (error) {
      if (version === this.version) tell(error.message);
    }
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

  saveSweep() {
    const titles = ["speed [km/h]", ...HEADS.map(([name]) => `standard deviation ${name} [N]`)];
    const rows = SPEEDS.map((speed) => [speed, ...this.swept.found.map((some) => some.get(speed) ?? "")]);
    this.context.save(this.swept, "sweep.csv", titles, rows);
  }

  save() {
    const titles = ["position [m]", ...(this.heads ?? []).map(([name]) => `contact force ${name} [N]`)];
    const rows = (this.results[0]?.positions ?? []).map((x, i) => [x, ...this.results.map(({ forces }) => forces[i])]);
    this.context.save(this, "line.csv", titles, rows);
  }
}
