// Where the rods stick, slide partly and slide all along, over frequency and amplitude.

import { Plot } from "./plot.mjs";

const AMPLITUDES = [0.05, 0.1, 0.14, 0.2, 0.28, 0.4, 0.56, 0.8, 1.1, 1.6, 2.2, 3.2, 4.5, 6.4, 9, 13]; // m/s2
const FREQUENCIES = Array.from({ length: 27 }, (_, i) => 2 + i / 2); // Hz
const STATES = [["stick", "#1f77b4"], ["partial slip", "#ff7f0e"], ["full slip", "#d62728"]];
const at = (id) => document.getElementById(id);

export class SlipView {
  constructor(context) {
    Object.assign(this, { context, points: [], version: 0 });
    this.plot = new Plot(at("slip-plot"), { x: "frequency  [Hz]", y: "peak acceleration of the head  [m/s²]", logY: true });
    at("slip-csv").onclick = () => {
      const rows = this.points.map(({ frequency, amplitude, state }) => [frequency, amplitude, state]);
      context.save(this, "slip.csv", ["frequency [Hz]", "amplitude [m/s2]", "state"], rows);
    };
  }

  async update(live) {
    if (live) return;
    const version = ++this.version, { pool, tell } = this.context, parameters = this.context.parameters();
    pool.drop("slip");
    if ((parameters.suspension ?? "ZSpring") !== "ZSpring") {
      this.points = [];
      this.plot.show([]);
      return (at("slip-state").textContent = `suspension ${parameters.suspension} has no joints that could slide`);
    }
    at("slip-state").textContent = "measuring";
    const found = [], made = this.context.head();
    try {
      await Promise.all(
        FREQUENCIES.map(async (frequency) => {
          const some = await pool.run("slip", "slip", { parameters, frequency, amplitudes: AMPLITUDES });
          if (version !== this.version) return;
          found.push(...some);
          Object.assign(this, { points: found, made });
          this.draw();
        }),
      );
    } catch (error) {
      if (version !== this.version) return;
      at("slip-state").textContent = "the map is of other parameters";
      tell(error.message);
    }
  }

  draw() {
    const done = new Set(this.points.map((p) => p.frequency)).size;
    at("slip-state").textContent = `${done} of ${FREQUENCIES.length} frequencies; a joint slides at 95 % of its bound; up to 100 mm of stroke`;
    const curves = STATES.map(([state, color]) => {
      const some = this.points.filter((p) => p.state === state);
      return { x: some.map((p) => p.frequency), y: some.map((p) => p.amplitude), color, dots: true, label: state };
    });
    this.plot.show(curves, { x: [1.5, 15.5], y: [0.04, 16] });
  }
}
