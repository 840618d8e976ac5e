// Frequency response by amplitude beside both linear models and a measured one.

import { colors, DASHES, pale, Plot } from "./plot.mjs";
import { cut, magnitude, phase, PointView } from "./point_view.mjs";
import { fill } from "./tables.mjs";

const LOWEST = 0.5, HIGHEST = 20; // Hz
const GRIDS = { coarse: 0.5, fine: 0.125 }; // Hz
const BOUNDS = { locked: "LinearLocked", free: "LinearFree" };
const MOST = 8, LARGEST = 20; // amplitudes, m/s2
const SHOWN = {
  magnitude: { y: "|H| = |Z/F|  [mm/N]", logY: true, of: magnitude, measured: ({ y }) => y.map((value) => 1e3 * value) },
  phase: { y: "phase of H = -Z/F  [°]", logY: false, of: phase, measured: (curve) => curve.phase.map(cut) },
};
const at = (id) => document.getElementById(id);

/** Frequencies in Hz between those of the fields, `step` apart. Throws Error. */
function grid(step) {
  const [low, high] = ["low", "high"].map((id) => at(id).valueAsNumber);
  if (!(low >= LOWEST && low < high && high <= HIGHEST)) throw new Error(`frequencies from ${at("low").value} to ${at("high").value} Hz: must ascend in ${LOWEST} .. ${HIGHEST}`);
  return Array.from({ length: Math.floor((high - low) / step + 1e-9) + 1 }, (_, i) => low + i * step);
}

/** Amplitudes from text, ascending. Throws Error. */
export function amplitudesOf(text) {
  const found = text.split(/[;,\s]+/).filter(Boolean).map((part) => {
    const value = Number(part);
    if (!(value > 0 && value <= LARGEST)) throw new Error(`amplitude ${part} m/s²: must be a number above 0, at most ${LARGEST}`);
    return value;
  });
  const apart = [...new Set(found)].sort((a, b) => a - b);
  if (!apart.length || apart.length > MOST) throw new Error(`${apart.length} amplitudes: must be 1 to ${MOST}`);
  return apart;
}

export class FrfView {
  constructor(context) {
    Object.assign(this, { context, pinned: null, measured: [], points: new Map(), step: 0, version: 0 });
    this.plot = new Plot(at("frf-plot"), {
      x: "frequency  [Hz]", ...SHOWN.magnitude,
      onPoint: (curve, i) => this.point.set(curve.amplitude, curve.x[i]),
      onKey: (key) => this.move(key),
    });
    this.point = new PointView(context, () => this.draw());
    at("frf-csv").onclick = () => this.save();
    at("frf-shows").onchange = () => {
      context.kept();
      this.draw();
      if (at("frf").getAttribute("aria-busy") === "false") at("frf-state").textContent = this.told();
    };
    for (const id of ["amplitudes", "low", "high"]) at(id).onchange = () => context.changed();
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
    const version = ++this.version, { pool, tell, stale } = this.context;
    const parameters = this.context.parameters(), made = this.context.head();
    if (!live) stale("frf", true);
    pool.drop("frf");
    const step = live ? GRIDS.coarse : GRIDS.fine;
    let amplitudes, frequencies;
    try {
      amplitudes = amplitudesOf(at("amplitudes").value);
      frequencies = grid(step);
    } catch (error) {
      at("frf-state").textContent = "the curves are of other amplitudes or frequencies";
      return tell(error.message);
    }
    at("frf-state").textContent = live ? "coarse while parameters move" : "measuring";
    const tasks = [
      ...amplitudes.map((amplitude) => [amplitude, parameters]),
      ...Object.entries(BOUNDS).map(([name, suspension]) => [name, { ...parameters, suspension }]),
    ].filter(([key]) => typeof key === "number" || parameters.suspension !== "Linear");
    this.point.update(live);
    try {
      const found = await Promise.all(
        tasks.map(([key, own]) => pool.run("frf", "sweep", { parameters: own, amplitude: typeof key === "number" ? key : 1, frequencies })),
      );
      if (version !== this.version) return;
      Object.assign(this, { points: new Map(tasks.map(([key], i) => [key, found[i]])), step, made, frequencies });
      stale("frf", false);
      this.draw();
      at("frf-state").textContent = this.told();
    } catch (error) {
      if (version !== this.version) return;
      tell(error.message);
      stale("frf", true);
      at("frf-state").textContent = "the curves are of other parameters";
    }
  }

  /** How the curves were measured, and what not to believe of them. */
  told() {
    const all = [...this.points.values()].flat(), count = (wanted) => all.filter(({ status }) => wanted.test(status)).length;
    const trouble = [[/^not/, "not settled (crossed out)"], [/^period/, "repeating only after several periods (crossed out)"], [/^failed/, "failed (left out)"]];
    const found = trouble.map(([wanted, what]) => [count(wanted), what]).filter(([n]) => n).map(([n, what]) => `; ${n} ${what}`);
    const beyond = [...this.points].filter(([key, points]) => typeof key === "number" && points.length < this.frequencies.length);
    const stroke = beyond.length ? `; from ${beyond.map(([key]) => `${key}`).join(", ")} m/s² low frequencies left out: stroke over 100 mm` : "";
    const other = this.measured.length ? this.others() : [];
    const untold = this.shows === SHOWN.phase && this.measured.some(({ phase }) => phase.some(Number.isNaN)) ? "; measured phases that the file does not tell are not drawn" : "";
    return `every ${this.step} Hz${found.join("")}${stroke}${untold}${other.length ? `; measured otherwise: ${other.join("; ")}` : ""}`;
  }

  /** By the keyboard along the curves: frequency, or the next amplitude. */
  move(key) {
    const keys = [...this.points.keys()].filter((one) => typeof one === "number"), { amplitude, frequency } = this.point.asked;
    const place = Math.max(0, keys.findIndex((one) => one >= amplitude));
    const by = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowDown: [-1, 0], ArrowUp: [1, 0] }[key];
    const next = keys[Math.min(keys.length - 1, Math.max(0, place + by[0]))] ?? amplitude;
    this.point.set(by[0] ? next : amplitude, Math.min(HIGHEST, Math.max(LOWEST, frequency + by[1] * GRIDS.fine)));
  }

  get shows() {
    return SHOWN[at("frf-shows").value] ?? SHOWN.magnitude;
  }

  curves(points = this.points) {
    const made = [], amplitudes = [...points.keys()].filter((key) => typeof key === "number"), own = colors(amplitudes.length);
    for (const [key, found] of points) {
      const bad = found.flatMap((p, i) => (p.status === "settled" ? [] : [i]));
      const curve = { x: found.map((p) => p.frequency), y: found.map(this.shows.of), bad };
      if (typeof key === "number") made.push({ ...curve, color: own[amplitudes.indexOf(key)], label: `${key} m/s²`, amplitude: key });
      else made.push({ ...curve, color: "#000", dash: key === "locked" ? DASHES.dashed : DASHES.dotted, label: `rods ${key}`, passive: true });
    }
    return made;
  }

  draw() {
    const amplitudes = [...this.points.keys()].filter((key) => typeof key === "number"), own = colors(amplitudes.length), other = colors(this.measured.length);
    const measured = this.measured.map((curve, i) => {
      const { label, acceleration, x } = curve, place = amplitudes.indexOf(acceleration);
      return { x, y: this.shows.measured(curve), dots: place < 0 ? "cross" : "ring", color: place < 0 ? other[i] : own[place], label: `measured ${label}`, passive: true };
    });
    const all = this.measured.flatMap(({ x }) => x).concat(this.frequencies ?? []);
    const { pinned } = this, { shown } = this.point;
    Object.assign(this.plot.options, this.shows);
    const before = pinned ? pale(this.curves(pinned.points), pinned.what) : [];
    this.plot.show([...before, ...this.curves(), ...measured], all.length ? { x: [Math.min(...all), Math.max(...all)] } : {}, shown && [shown.frequency, this.shows.of(shown)]);
    const rows = [["amplitude", "Hz, mm/N"]];
    for (const [key, points] of this.points) {
      const peaks = points.slice(1, -1).filter((p, i) => magnitude(p) > magnitude(points[i]) && magnitude(p) > magnitude(points[i + 2]));
      const told = peaks.map((p) => `${p.frequency} Hz ${magnitude(p).toPrecision(3)}${p.status === "settled" ? "" : ` (${p.status})`}`);
      rows.push([typeof key === "number" ? `${key} m/s²` : `rods ${key}`, told.join(";  ")]);
    }
    at("resonances").caption.textContent = `Resonances: points above both neighbours; the peak is within ${this.step} Hz of each, and higher`;
    fill(at("resonances"), rows);
  }

  /**
   * Measured curves over the figure, its amplitudes where the file tells them, and its frequencies.
   * others(): lines of text, what is other in the measurement.
   */
  show(measured, name, others) {
    Object.assign(this, { measured, others });
    at("unmeasure").hidden = !measured.length;
    at("unmeasure").textContent = `Remove ${name}`;
    const told = [...new Set(measured.map(({ acceleration }) => acceleration))];
    if (measured.length && told.length <= MOST && told.every((value) => value > 0 && value <= LARGEST)) at("amplitudes").value = told.sort((a, b) => a - b).join(", ");
    const all = measured.flatMap(({ x }) => x), low = Math.max(LOWEST, Math.floor(Math.min(...all))), high = Math.min(HIGHEST, Math.ceil(Math.max(...all)));
    if (low < high) [at("low").value, at("high").value] = [low, high];
    this.context.changed();
  }

  pin(what) {
    this.pinned = { points: this.points, what };
    this.draw();
  }

  unpin() {
    this.pinned = null;
    this.draw();
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
