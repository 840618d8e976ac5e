// One point of a frequency response: the linkage in motion, joint moments, contact force and its harmonics.

import { displacementOf, STROKE } from "./bench.mjs";
import { drawLinkage } from "./draw.mjs";
import { DASHES, Plot } from "./plot.mjs";
import { fill } from "./tables.mjs";

const SLIDES = 0.95; // of Mf, as `zspring slip` counts
const SLOWER = 12; // times
const MAGNIFIED = [1, 2, 5, 10, 20, 50, 100];
const VISIBLE = { length: 0.03, angle: 0.35 }; // m, rad: the largest motion drawn
const at = (id) => document.getElementById(id);
/** Degrees as near -90 as may be, where a driving point has them. */
export const cut = (degrees) => degrees - 360 * Math.round((degrees + 90) / 360);
export const phase = (point) => (point.H ? cut((Math.atan2(point.H[1], point.H[0]) * 180) / Math.PI) : NaN);
export const magnitude = (point) => (point.H ? 1e3 * Math.hypot(...point.H) : NaN); // mm/N


/** Whether the rods can stick and slide: `zspring slip` asks the same. */
export const hasDryFriction = (parameters) =>
  (parameters.suspension ?? "ZSpring") === "ZSpring" && /^(Regularized|Coulomb)$/.test(parameters.friction ?? "Regularized") && parameters["zspring.Mf"] !== 0;

export class PointView {
  /** drawn(): called when `mark`, the point's place in the figure, has changed. */
  constructor(context, drawn) {
    Object.assign(this, { context, drawn, cycle: null, mark: null, version: 0 });
    this.moments = new Plot(at("moments"), { x: "angle from the static one  [deg]", y: "friction moment  [N·m]", room: true });
    this.force = new Plot(at("force"), { x: "time  [ms]", y: "contact force  [N]" });
    at("point-amplitude").onchange = at("point-frequency").onchange = () => this.update(false);
    const move = (time) => {
      if (at("animate").checked) this.drawLinkage(time / 1e3);
      requestAnimationFrame(move);
    };
    requestAnimationFrame(move);
    at("magnify").onchange = () => this.drawLinkage(0);
    new ResizeObserver(() => this.drawLinkage(0)).observe(at("linkage"));
  }

  get asked() {
    return { amplitude: at("point-amplitude").valueAsNumber, frequency: at("point-frequency").valueAsNumber };
  }

  set(amplitude, frequency) {
    at("point-amplitude").value = amplitude;
    at("point-frequency").value = frequency;
    this.update(false);
  }

  async update(live) {
    const version = ++this.version, { pool, tell, stale } = this.context;
    stale("point", true);
    if (live) return void (at("point-text").textContent = "the point is measured once the parameters rest");
    const { amplitude, frequency } = this.asked, stroke = displacementOf(amplitude, frequency);
    const wrong = [["point-amplitude", "amplitude"], ["point-frequency", "frequency"]].filter(([id]) => at(id).value === "" || !at(id).checkValidity())
      .map(([id, name]) => `${name} of the point = ${at(id).value}: must be in ${at(id).min} .. ${at(id).max}`);
    if (stroke > STROKE) wrong.push(`${amplitude} m/s² at ${frequency} Hz is a displacement of ${(1e3 * stroke).toPrecision(3)} mm: must be at most ${1e3 * STROKE} mm`);
    if (wrong.length) return void (at("point-text").textContent = `${wrong[0]}; what is below is another point`);
    pool.drop("cycle");
    at("point-text").textContent = "measuring the point";
    const parameters = this.context.parameters();
    try {
      const cycle = await pool.run("cycle", "cycle", { parameters, amplitude, frequency });
      if (version !== this.version) return;
      stale("point", false);
      this.show(cycle, parameters);
    } catch (error) {
      if (version !== this.version) return;
      at("point-text").textContent = "what is below is another point";
      tell(error.message);
    }
  }

  show({ point, names, rows, fixed }, parameters) {
    const column = (name) => rows.map((row) => row[names.indexOf(name)]);
    const [theta, L1, L2, d, bound] = fixed;
    const largest = (values) => values.reduce((most, value) => Math.max(most, Math.abs(value)), 0);
    const angles = ["alpha", "beta"].map((name) => column(`zspring.${name}`).map((angle) => angle - theta));
    const fits = (factor) => factor * largest([...column("head.z"), ...column("upper_frame.z")]) <= VISIBLE.length && factor * largest(angles.flat()) <= VISIBLE.angle;
    const magnified = MAGNIFIED.findLast(fits) ?? 1;
    this.cycle = { geometry: { theta, L1, L2, d }, frequency: point.frequency, rows, names, bound: hasDryFriction(parameters) ? bound : Infinity, magnified };
    this.shown = point.H ? point : null;
    this.drawn();
    this.drawLinkage(0);
    const linear = parameters.suspension === "Linear";
    const share = [column("zspring.moment_alpha"), column("zspring.moment_beta")].map((moments) => moments.map((m) => Math.abs(m) / bound));
    const slides = share.map((some) => Math.round((100 * some.filter((s) => s >= SLIDES).length) / (some.length || 1)));
    at("point-text").textContent = point.H
      ? `${point.acceleration} m/s² at ${point.frequency} Hz: |H| = ${magnitude(point).toPrecision(4)} mm/N, phase ${phase(point).toFixed(1)}°, ${point.status} after ${point.periods} periods; ` +
        (!hasDryFriction(parameters) ? "no joint with dry friction" : `the joint at the head slides ${slides[0]}\u00a0%, that at the frame ${slides[1]}\u00a0% of the period`) +
        (Math.min(...column("contact.force")) < 0 ? "; the force falls below 0: the bench holds the head, a wire would lose it" : "")
      : point.status;
    const closed = (values) => [...values, values[0]];
    const degrees = (values) => closed(values.map((value) => (value * 180) / Math.PI));
    const joints = [["alpha", "#2a788e", "solid", "at the head"], ["beta", "#c60", "dashed", "at the frame"]];
    this.moments.show(
      linear || !rows.length ? [] : joints.map(([name, color, dash, label], i) => ({ x: degrees(angles[i]), y: closed(column(`zspring.moment_${name}`)), color, dash: DASHES[dash], label })),
    );
    const times = rows.map((_, i) => (1e3 * (i + 1)) / (point.frequency * rows.length));
    this.force.show(rows.length ? [{ x: times, y: column("contact.force"), color: "#12395b" }] : []);
    const first = point.H ? point.acceleration / (2 * Math.PI * point.frequency) ** 2 / Math.hypot(...point.H) : NaN;
    const harmonics = point.H ? [first, ...point.harmonics] : [];
    fill(at("harmonics"), [["harmonic", "force, N", "of the first"], ...harmonics.map((force, i) => [String(i + 1), force.toPrecision(3), `${((100 * force) / first).toFixed(1)} %`])]);
  }

  drawLinkage(seconds) {
    if (!this.cycle?.rows.length || at("linkage").offsetParent === null) return;
    const { rows, names, geometry, frequency, bound, magnified } = this.cycle, { theta } = geometry;
    const place = Math.floor((((seconds * frequency) / SLOWER) % 1) * rows.length), factor = at("magnify").checked ? magnified : 1;
    const value = (name) => rows[place][names.indexOf(name)];
    const turned = (name) => theta + factor * (value(name) - theta);
    const state = { head: factor * value("head.z"), frame: factor * value("upper_frame.z"), alpha: turned("zspring.alpha"), beta: turned("zspring.beta") };
    const sliding = ["alpha", "beta"].map((joint) => Math.abs(value(`zspring.moment_${joint}`)) >= SLIDES * bound);
    drawLinkage(at("linkage"), geometry, state, sliding, factor);
  }
}
