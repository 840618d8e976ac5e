// Frequency response by amplitude between its linear bounds, and the point that was chosen.

import { drawLinkage } from "./draw.mjs";
import { COLORS, DASHES, Plot } from "./plot.mjs";

const AMPLITUDES = [0.25, 0.5, 1, 2, 4, 8]; // m/s2, of the standard figure
const LOW = 2, HIGH = 14; // Hz
const GRIDS = { coarse: 0.5, fine: 0.125 }; // Hz
const BOUNDS = { locked: "LinearLocked", free: "LinearFree" };
const SLIDES = 0.95; // of Mf, as `zspring slip` counts
const SLOWER = 12; // periods of the screen for one of the bench, at 5 Hz
const at = (id) => document.getElementById(id);
const magnitude = (point) => (point.H ? 1e3 * Math.hypot(...point.H) : NaN); // mm/N

const grid = (step) => Array.from({ length: Math.round((HIGH - LOW) / step) + 1 }, (_, i) => LOW + i * step);

/** Table rows from arrays of texts; the first one is the head. */
export function fill(table, rows) {
  const caption = table.caption;
  table.replaceChildren(...(caption ? [caption] : []));
  rows.forEach((row, i) => {
    const line = table.insertRow();
    for (const text of row) {
      const cell = document.createElement(i ? "td" : "th");
      cell.textContent = text;
      if (!i) cell.scope = "col";
      line.append(cell);
    }
  });
}

export class FrfView {
  constructor(context) {
    Object.assign(this, { context, pinned: [], measured: [], points: new Map(), step: 0, version: 0, cycle: null });
    const choose = (curve, i, chosen) => {
      if (!curve.amplitude) return;
      if (chosen) {
        at("point-amplitude").value = curve.amplitude;
        at("point-frequency").value = curve.x[i];
        this.choose();
      } else at("frf-state").textContent = `${curve.label}: ${curve.x[i]} Hz, ${curve.y[i].toPrecision(4)} mm/N; click for its motion`;
    };
    this.plot = new Plot(at("frf-plot"), { x: "frequency  [Hz]", y: "|H| = |Z/F|  [mm/N]", logY: true, onPoint: choose });
    this.moments = new Plot(at("moments"), { x: "angle from the static one  [deg]", y: "friction moment  [N·m]" });
    this.force = new Plot(at("force"), { x: "time  [ms]", y: "contact force  [N]" });
    at("point-amplitude").onchange = at("point-frequency").onchange = () => this.choose();
    at("frf-csv").onclick = () => this.save();
    const move = (time) => {
      if (at("animate").checked) this.drawLinkage(time / 1e3);
      requestAnimationFrame(move);
    };
    requestAnimationFrame(move);
  }

  /** Measure the figure with the parameters as they are; while they move coarse, one figure after the other. */
  async update(live) {
    if (live && this.coarse) {
      this.again = true;
      return;
    }
    this.again = false;
    this.coarse = live;
    await this.measure(live);
    if (live) this.coarse = false;
    if (live && this.again) this.update(true);
  }

  async measure(live) {
    const version = ++this.version, { pool } = this.context;
    const parameters = this.context.parameters(), made = this.context.head();
    this.measuring = true;
    const step = live ? GRIDS.coarse : GRIDS.fine, frequencies = grid(step);
    if (!live) pool.drop("frf");
    at("frf-state").textContent = live ? "coarse while parameters move" : "measuring";
    const tasks = [
      ...AMPLITUDES.map((amplitude) => [amplitude, parameters]),
      ...Object.entries(BOUNDS).map(([name, suspension]) => [name, { ...parameters, suspension }]),
    ].filter(([key]) => typeof key === "number" || parameters.suspension !== "Linear");
    if (live) at("point-text").textContent = "the point is measured once the parameters rest";
    else this.choose();
    const points = new Map();
    try {
      await Promise.all(
        tasks.map(async ([key, own]) => {
          const amplitude = typeof key === "number" ? key : 1;
          const found = await pool.run("frf", "sweep", { parameters: own, amplitude, frequencies });
          if (version !== this.version) return;
          points.set(key, found);
          if (points.size === tasks.length) {
            Object.assign(this, { points, step, made, measuring: false });
            this.draw();
          }
        }),
      );
    } catch (error) {
      if (version !== this.version) return;
      this.context.tell(error.message);
      at("frf-state").textContent = "the curves are of other parameters";
    }
  }

  curves() {
    const made = [];
    for (const amplitude of AMPLITUDES) {
      const found = this.points.get(amplitude);
      if (found)
        made.push({ x: found.map((p) => p.frequency), y: found.map(magnitude), color: COLORS[AMPLITUDES.indexOf(amplitude)], label: `${amplitude} m/s²`, amplitude });
    }
    for (const [name, dash] of [["locked", DASHES.dashed], ["free", DASHES.dotted]]) {
      const found = this.points.get(name);
      if (found) made.push({ x: found.map((p) => p.frequency), y: found.map(magnitude), color: "#000", dash, label: `linear, rods ${name}`, passive: true });
    }
    return made;
  }

  draw() {
    const pinned = this.pinned.map((curve) => ({ ...curve, color: `${curve.color}55`, width: 3, label: "", passive: true }));
    const measured = this.measured.map(({ label, x, y }) => ({ x, y: y.map((value) => 1e3 * value), dots: true, color: "#c00", label: `measured ${label}`, passive: true }));
    this.plot.show([...pinned, ...this.curves(), ...measured], { x: [LOW, HIGH] }, this.mark);
    const unsettled = [...this.points.values()].flat().filter((p) => p.status !== "settled").length;
    if (!this.measuring) at("frf-state").textContent = `every ${this.step} Hz` + (unsettled ? `; ${unsettled} points repeat only after several periods, did not settle or failed` : "");
    const rows = [["amplitude", "resonances: Hz, mm/N"]];
    for (const [key, points] of this.points) {
      const peaks = points.slice(1, -1).filter((p, i) => magnitude(p) > magnitude(points[i]) && magnitude(p) > magnitude(points[i + 2]));
      const told = peaks.map((p) => `${p.frequency} ± ${this.step}, ${magnitude(p).toPrecision(2)}`);
      rows.push([typeof key === "number" ? `${key} m/s²` : `rods ${key}`, told.join(";  ")]);
    }
    fill(at("resonances"), rows);
  }

  pin() {
    this.pinned = this.curves();
    this.draw();
  }

  unpin() {
    Object.assign(this, { pinned: [], measured: [] });
    this.draw();
  }

  /** The steady state at the amplitude and frequency of the fields. */
  async choose() {
    const { pool, tell } = this.context, parameters = this.context.parameters();
    const amplitude = at("point-amplitude").valueAsNumber, frequency = at("point-frequency").valueAsNumber;
    for (const id of ["point-amplitude", "point-frequency"])
      if (!at(id).checkValidity() || !(at(id).valueAsNumber > 0)) return tell(`${id.slice(6)} = ${at(id).value}: must be in ${at(id).min} .. ${at(id).max}`);
    pool.drop("cycle");
    at("point-text").textContent = "measuring the point";
    const asked = (this.asked = (this.asked ?? 0) + 1);
    try {
      const cycle = await pool.run("cycle", "cycle", { parameters, amplitude, frequency });
      if (asked === this.asked) this.showCycle(cycle, parameters);
    } catch (error) {
      if (asked !== this.asked) return;
      at("point-text").textContent = "the motion below is of other parameters";
      tell(error.message);
    }
  }

  showCycle({ point, names, rows, fixed }, parameters) {
    const column = (name) => rows.map((row) => row[names.indexOf(name)]);
    const [theta, L1, L2, d, bound] = fixed;
    this.cycle = { geometry: { theta, L1, L2, d }, frequency: point.frequency, rows, names, bound };
    this.mark = point.H ? [point.frequency, magnitude(point)] : null;
    this.draw();
    this.drawLinkage(0);
    const linear = parameters.suspension === "Linear";
    const share = [column("zspring.moment_alpha"), column("zspring.moment_beta")].map((moments) => moments.map((m) => Math.abs(m) / bound));
    const slides = share.map((some) => Math.round((100 * some.filter((s) => s >= SLIDES).length) / (some.length || 1)));
    const phase = point.H ? (Math.atan2(point.H[1], point.H[0]) * 180) / Math.PI : NaN;
    at("point-text").textContent = point.H
      ? `${point.acceleration} m/s² at ${point.frequency} Hz: |H| = ${magnitude(point).toPrecision(4)} mm/N, phase ${phase.toFixed(1)}°, ${point.status} after ${point.periods} periods; ` +
        (linear ? "no joints" : `the joint at the head slides ${slides[0]} %, that at the frame ${slides[1]} % of the period`)
      : point.status;
    const closed = (values) => [...values, values[0]];
    const degrees = (values) => closed(values.map((value) => ((value - theta) * 180) / Math.PI));
    const joints = [["alpha", "#2a788e", "solid"], ["beta", "#c60", "dashed"]];
    this.moments.show(
      linear || !rows.length ? [] : joints.map(([name, color, dash]) => ({ x: degrees(column(`zspring.${name}`)), y: closed(column(`zspring.moment_${name}`)), color, dash: DASHES[dash], label: name === "alpha" ? "at the head" : "at the frame" })),
    );
    const times = rows.map((_, i) => (1e3 * (i + 1)) / (point.frequency * rows.length));
    this.force.show(rows.length ? [{ x: times, y: column("contact.force"), color: "#12395b" }] : []);
    const first = point.H ? point.acceleration / (2 * Math.PI * point.frequency) ** 2 / Math.hypot(...point.H) : NaN;
    fill(at("harmonics"), [["harmonic", "force, N", "of the first"], ["1", first.toPrecision(3), "100 %"], ...point.harmonics.map((force, i) => [String(i + 2), force.toPrecision(3), `${((100 * force) / first).toFixed(1)} %`])]);
  }

  drawLinkage(seconds) {
    if (!this.cycle?.rows.length || at("linkage").offsetParent === null) return;
    const { rows, names, geometry, frequency, bound } = this.cycle;
    const place = Math.floor((((seconds * frequency) / SLOWER) % 1) * rows.length);
    const value = (name) => rows[place][names.indexOf(name)];
    const state = { head: value("head.z"), frame: value("upper_frame.z"), alpha: value("zspring.alpha"), beta: value("zspring.beta") };
    drawLinkage(at("linkage"), geometry, state, ["alpha", "beta"].map((joint) => Math.abs(value(`zspring.moment_${joint}`)) >= SLIDES * bound));
  }

  save() {
    const rows = [];
    for (const [key, points] of this.points)
      if (typeof key === "number")
        for (const p of points) rows.push([p.frequency, key, ...(p.H ?? ["", ""]), p.status]);
    const titles = ["frequency [Hz]", "amplitude [m/s2]", "H_re [m/N]", "H_im [m/N]", "status"];
    this.context.save(this, "frf.csv", titles, rows);
  }
}
