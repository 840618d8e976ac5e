// Static force of the head suspension against its deflection: slow loops with a clamped frame.

import { colors, pale, Plot } from "./plot.mjs";
import { fill } from "./tables.mjs";

const AMPLITUDES = [0.5, 1, 2, 5, 10, 20]; // mm
const at = (id) => document.getElementById(id);

export class StaticView {
  constructor(context) {
    Object.assign(this, { context, loops: [], pinned: [], version: 0 });
    this.plot = new Plot(at("static-plot"), { x: "compression, frame minus head  [mm]", y: "force beyond the static one  [N]", room: true });
    at("rate").onchange = () => context.changed();
    at("static-csv").onclick = () => {
      const rows = this.loops.flatMap(({ amplitude, compression, force }) => compression.map((x, i) => [amplitude / 1e3, x, force[i]]));
      const titles = ["amplitude [m]", "compression [m]", "force [N]"];
      context.save(this, "loops.csv", titles, rows);
    };
  }

  async update(live) {
    const version = ++this.version, { pool, tell, stale } = this.context, parameters = this.context.parameters();
    stale("static", true);
    pool.drop("static");
    if (live) return void (at("static-state").textContent = "measured once the parameters rest");
    const made = { ...this.context.head(), rate: `${at("rate").value} mm/s` }, rate = at("rate").valueAsNumber / 1e3;
    at("static-state").textContent = "measuring";
    try {
      if (!at("rate").checkValidity() || !(rate > 0)) throw new Error(`speed = ${at("rate").value} mm/s: must be in 0.01 .. 100`);
      const loops = await Promise.all(
        AMPLITUDES.map(async (amplitude) => ({ amplitude, ...(await pool.run("static", "loop", { parameters, amplitude: amplitude / 1e3, rate })) })),
      );
      if (version !== this.version) return;
      Object.assign(this, { loops, made });
      stale("static", false);
      at("static-state").textContent = "slow loops with a clamped frame, as `zspring static` makes them";
      this.draw();
    } catch (error) {
      if (version !== this.version) return;
      at("static-state").textContent = this.loops.length ? "the loops are of other parameters" : "";
      tell(error.message);
    }
  }

  curves() {
    return this.loops.map(({ amplitude, compression, force }, i) => ({ x: compression.map((x) => 1e3 * x), y: force, color: colors(AMPLITUDES.length)[i], label: `${amplitude} mm` }));
  }

  draw() {
    this.plot.show([...this.pinned, ...this.curves()]);
    const head = ["amplitude, mm", "stiffness, N/mm", ...(this.before ? [`pinned: ${this.before.what}`] : [])];
    const stiffness = this.stiffness();
    fill(at("stiffness"), [head, ...this.loops.map(({ amplitude }, i) => [String(amplitude), stiffness[i], ...(this.before ? [this.before.stiffness[i]] : [])])]);
  }

  /** Secants from peak to peak, texts in N/mm. */
  stiffness() {
    return this.loops.map(({ compression: x, force: f }) => ((f[0] - f[(f.length - 1) / 2]) / (x[0] - x[(x.length - 1) / 2]) / 1e3).toPrecision(4));
  }

  pin(what) {
    this.pinned = pale(this.curves(), what);
    this.before = { what, stiffness: this.stiffness() };
    this.draw();
  }

  unpin() {
    Object.assign(this, { pinned: [], before: null });
    this.draw();
  }
}
