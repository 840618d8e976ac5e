// Where the rods stick, slide partly and slide all along, over frequency and amplitude.

import { pale, Plot } from "./plot.mjs";
import { hasDryFriction } from "./point_view.mjs";
import { fill } from "./tables.mjs";

const AMPLITUDES = [0.05, 0.1, 0.14, 0.2, 0.28, 0.4, 0.56, 0.8, 1.1, 1.6, 2.2, 3.2, 4.5, 6.4, 9, 13]; // m/s2
const FREQUENCIES = Array.from({ length: 27 }, (_, i) => 2 + i / 2); // Hz
const STATES = [["stick", "#1f77b4", "cross"], ["partial slip", "#c4500c", "ring"], ["full slip", "#a3105c", "full"], ["failed", "#222", "cross"]];
const at = (id) => document.getElementById(id);

export class SlipView {
  constructor(context) {
    Object.assign(this, { context, points: [], pinned: [], version: 0 });
    this.plot = new Plot(at("slip-plot"), { x: "frequency  [Hz]", y: "peak acceleration of the head  [m/s²]", logY: true });
    at("slip-csv").onclick = () => {
      const rows = this.points.map(({ frequency, amplitude, state }) => [frequency, amplitude, state || "failed"]);
      context.save(this, "slip.csv", ["frequency [Hz]", "amplitude [m/s2]", "state"], rows);
    };
  }

  async update(live) {
    const version = ++this.version, { pool, tell, stale } = this.context, parameters = this.context.parameters();
    pool.drop("slip");
    stale("slip", true);
    if (live) return void (at("slip-state").textContent = "measured once the parameters rest");
    if (!hasDryFriction(parameters)) {
      Object.assign(this, { points: [], made: null });
      this.draw();
      stale("slip", false);
      return void (at("slip-state").textContent = "no joint with dry friction: needs suspension ZSpring, friction Regularized or Coulomb, and zspring.Mf above 0");
    }
    const points = [], made = this.context.head();
    let done = 0;
    try {
      await Promise.all(
        FREQUENCIES.map(async (frequency) => {
          points.push(...(await pool.run("slip", "slip", { parameters, frequency, amplitudes: AMPLITUDES })));
          if (version === this.version) at("slip-state").textContent = `${++done} of ${FREQUENCIES.length} frequencies`;
        }),
      );
      if (version !== this.version) return;
      points.sort((a, b) => a.frequency - b.frequency || a.amplitude - b.amplitude);
      Object.assign(this, { points, made });
      stale("slip", false);
      at("slip-state").textContent += "; a joint slides at 95 % of its bound; up to 100 mm of stroke; amplitude raised from rest";
      this.draw();
    } catch (error) {
      if (version !== this.version) return;
      at("slip-state").textContent = this.points.length ? "the map is of other parameters" : "";
      tell(error.message);
    }
  }

  /** Least amplitude by frequency in one of these states; NaN where it was not reached. */
  onset(...states) {
    return FREQUENCIES.map((frequency) => this.points.find((p) => p.frequency === frequency && states.includes(p.state))?.amplitude ?? NaN);
  }

  lines() {
    const line = (y, state) => ({ x: FREQUENCIES, y, color: STATES[state][1], label: `${STATES[state][0]} from`, passive: true });
    return this.points.length ? [line(this.onset("partial slip", "full slip"), 1), line(this.onset("full slip"), 2)] : [];
  }

  draw() {
    const curves = STATES.map(([state, color, dots]) => {
      const some = this.points.filter((p) => (p.state || "failed") === state);
      return { x: some.map((p) => p.frequency), y: some.map((p) => p.amplitude), color, dots, label: some.length ? state : "" };
    });
    this.plot.show([...this.pinned, ...curves], { x: [1.5, 15.5], y: [0.04, 16] });
    const told = (values) => values.map((value) => (Number.isFinite(value) ? String(value) : "not reached"));
    const [partial, full] = [told(this.onset("partial slip", "full slip")), told(this.onset("full slip"))];
    fill(at("onsets"), this.points.length ? [["frequency, Hz", "a joint slides from, m/s²", "all along from, m/s²"], ...FREQUENCIES.map((f, i) => [String(f), partial[i], full[i]])] : []);
  }

  pin(what) {
    this.pinned = pale(this.lines(), what);
    this.draw();
  }

  unpin() {
    this.pinned = [];
    this.draw();
  }
}
