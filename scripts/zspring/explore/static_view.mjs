// Static force of the head suspension against its deflection: slow loops with a clamped frame.

import { fill } from "./frf_view.mjs";
import { COLORS, Plot } from "./plot.mjs";

const AMPLITUDES = [0.5, 1, 2, 5, 10, 20]; // mm
const at = (id) => document.getElementById(id);

export class StaticView {
  constructor(context) {
    Object.assign(this, { context, loops: [], pinned: [], version: 0 });
    this.plot = new Plot(at("static-plot"), { x: "compression, frame minus head  [mm]", y: "force beyond the static one  [N]", legend: "left" });
    at("rate").onchange = () => this.update(false);
    at("static-csv").onclick = () => {
      const rows = this.loops.flatMap(({ amplitude, compression, force }) => compression.map((x, i) => [amplitude / 1e3, x, force[i]]));
      const titles = ["amplitude [m]", "compression [m]", "force [N]"];
      context.save(this, "loops.csv", titles, rows);
    };
  }

  async update(live) {
    if (live) return;
    const version = ++this.version, { pool, tell } = this.context, parameters = this.context.parameters();
    const made = { ...this.context.head(), rate: `${at("rate").value} mm/s` };
    const rate = at("rate").valueAsNumber / 1e3;
    if (!at("rate").checkValidity() || !(rate > 0)) return tell(`speed = ${at("rate").value} mm/s: must be in 0.01 .. 100`);
    pool.drop("static");
    at("static-state").textContent = "measuring";
    try {
      const loops = await Promise.all(
        AMPLITUDES.map(async (amplitude) => ({ amplitude, ...(await pool.run("static", "loop", { parameters, amplitude: amplitude / 1e3, rate })) })),
      );
      if (version !== this.version) return;
      Object.assign(this, { loops, made });
      at("static-state").textContent = "slow loops with a clamped frame, as `zspring static` makes them";
      this.draw();
    } catch (error) {
      if (version !== this.version) return;
      at("static-state").textContent = "the loops are of other parameters";
      tell(error.message);
    }
  }

  curves() {
    return this.loops.map(({ amplitude, compression, force }, i) => ({ x: compression.map((x) => 1e3 * x), y: force, color: COLORS[i], label: `${amplitude} mm` }));
  }

  draw() {
    this.plot.show([...this.pinned.map((curve) => ({ ...curve, color: `${curve.color}55`, width: 3, label: "" })), ...this.curves()]);
    const secant = ({ compression: x, force: f }) => (f[0] - f[(f.length - 1) / 2]) / (x[0] - x[(x.length - 1) / 2]) / 1e3;
    fill(at("stiffness"), [["amplitude, mm", "stiffness, N/mm"], ...this.loops.map((loop) => [String(loop.amplitude), secant(loop).toPrecision(4)])]);
  }

  pin() {
    this.pinned = this.curves();
    this.draw();
  }

  unpin() {
    this.pinned = [];
    this.draw();
  }
}
