// Standard deviation of the contact force over speed.

import { DASHES, pale, Plot } from "./plot.mjs";
import { fill } from "./tables.mjs";

const SPEEDS = [160, 180, 200, 220, 240, 250, 260, 280, 300, 320, 350]; // km/h
const at = (id) => document.getElementById(id);

export class SweepView {
  /** line: the LineView, whose settings it takes. */
  constructor(line, context) {
    Object.assign(this, { line, context, version: 0, swept: null, pinned: [] });
    this.plot = new Plot(at("sweep-plot"), { x: "speed  [km/h]", y: "standard deviation, 0 to 20 Hz  [N]" });
    at("sweep").onclick = () => this.run();
    at("sweep-csv").onclick = () => this.save();
  }

  /** What a sweep is made with, of what a run is made with. */
  key({ speed, ...made }) {
    return JSON.stringify(made);
  }

  /** Whether the sweep that is shown or runs is of what a run is made with now; one that runs for other settings ends. */
  check(made) {
    if (!this.swept) return;
    const same = this.key(made) === this.swept.key, { pool, stale } = this.context;
    stale("sweep-result", !same);
    if (same) return void this.draw();
    ++this.version;
    pool.drop("sweep");
    at("sweep-state").textContent = "this sweep is of other settings";
  }

  async run() {
    const { line, context } = this, { heads } = line, version = ++this.version;
    const all = SPEEDS.map((speed) => [speed, line.asked(speed)]);
    if (all.some(([, settings]) => !settings)) return;
    const now = line.head(), { speed: _, ...made } = now;
    this.swept = { made, key: this.key(now), heads, found: heads.map(() => new Map()), doubts: new Map(all.map(([speed, { doubts }]) => [speed, doubts])) };
    const { swept } = this;
    context.pool.drop("sweep");
    at("sweep-result").hidden = false;
    context.stale("sweep-result", false);
    this.draw();
    try {
      await Promise.all(
        all.flatMap(([speed, settings]) =>
          heads.map(async ([, own], i) => {
            const { statistics } = await line.of(settings, own, false, "sweep");
            if (version !== this.version) return;
            swept.found[i].set(speed, statistics.deviation);
            this.draw();
          }),
        ),
      );
    } catch (error) {
      if (version === this.version) context.tell(error.message);
    }
  }

  draw() {
    const { heads, found, doubts } = this.swept, done = found.reduce((n, some) => n + some.size, 0);
    const doubted = SPEEDS.filter((speed) => doubts.get(speed).length);
    this.curves = heads.map(([name, , color, dash], i) => {
      const x = SPEEDS.filter((speed) => found[i].has(speed));
      return { x, y: x.map((speed) => found[i].get(speed)), bad: x.flatMap((speed, k) => (doubted.includes(speed) ? [k] : [])), color, dash: DASHES[dash], label: name };
    });
    this.plot.show([...this.pinned, ...this.curves]);
    const doubt = doubted.length ? `; do not rely on what is crossed out, at ${doubted.join(", ")} km/h: ${doubts.get(doubted[0]).join("; ")}` : "";
    at("sweep-state").textContent = `sweep: ${done} of ${heads.length * SPEEDS.length} runs${doubt}`;
    const value = (i, speed) => found[i].get(speed)?.toFixed(1) ?? "";
    fill(at("deviations"), [["speed, km/h", ...heads.map(([name]) => `${name}, N`)], ...SPEEDS.map((speed) => [String(speed), ...heads.map((_, i) => value(i, speed))])]);
  }

  /** Keeps the sweep of the head as it is set, if it is of the parameters as they are; nothing for null. */
  pin(what) {
    if (what && at("sweep-result").classList.contains("stale")) return;
    this.pinned = what && this.swept ? pale(this.curves.slice(0, 1), what) : [];
    if (this.swept) this.plot.show([...this.pinned, ...this.curves]);
  }

  save() {
    const { made, heads, found, doubts } = this.swept;
    const titles = ["speed [km/h]", ...heads.map(([name]) => `standard deviation ${name} [N]`), "doubts"];
    const rows = SPEEDS.map((speed) => [speed, ...found.map((some) => some.get(speed) ?? ""), doubts.get(speed).join("; ")]);
    this.context.save({ made }, "sweep.csv", titles, rows);
  }
}
