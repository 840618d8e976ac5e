// Frequency responses by the FMU's own bench: the steps that zspring/bench/measure.py makes, in the same order.

import { StepDiscarded } from "./fmi2.mjs";
import { meanResponse, repeatsAfter } from "./steady.mjs";

export const STROKE = 0.1; // m, the largest displacement peak
const LOOK = 4, FEWEST = 8, MOST = 400; // periods
const COUNTERS = ["solver.steps", "solver.iterations", "solver.refinements"];
const HARMONICS = [2, 3, 4, 5, 6, 7].map((n) => `bench.harmonic[${n}]`);

export const displacementOf = (acceleration, frequency) => acceleration / (2 * Math.PI * frequency) ** 2;

/** One instance with drive Bench that is swept through frequencies; parameters by name. */
export class Bench {
  constructor(instance, parameters) {
    this.instance = instance;
    this.parameters = { ...parameters, drive: "Bench" };
    this.moves = false;
  }

  /** From rest where it stands or where a step failed, else without stopping. Hz, m/s2. */
  tune(frequency, acceleration) {
    const settings = { "bench.frequency": frequency, "bench.acceleration": acceleration };
    this.frequency = frequency;
    if (this.moves) this.instance.set(settings);
    else {
      this.time = 0;
      this.instance.start({ ...this.parameters, ...settings });
    }
    this.moves = true;
  }

  period() {
    const size = 1 / this.frequency;
    this.instance.step(this.time, size);
    this.time += size;
  }

  /**
   * {frequency, acceleration, H: [re, im] in m/N, status, periods, steps, iterations, refinements, harmonics in N, loss
   * in J}: run until H repeats within the tolerance or for the most periods. H is null where a step was discarded.
   */
  measure(frequency, acceleration, tolerance = 1e-3) {
    this.tune(frequency, acceleration);
    const { instance } = this;
    const before = instance.get(COUNTERS), H = [], dissipated = [];
    const point = { frequency, acceleration, H: null, status: "not settled", harmonics: [], loss: NaN };
    let repeat = 0, counting = false;
    try {
      while (!repeat && H.length < MOST) {
        this.period();
        dissipated.push(instance.get(["energy.dissipated"])[0]);
        counting ||= instance.get(["bench.periods"])[0] > 0; // the ramp may take some periods
        if (counting) H.push(instance.get(["bench.H_re", "bench.H_im"]));
        if (H.length === MOST || (H.length >= FEWEST && H.length % LOOK === 0)) [repeat] = repeatsAfter(H, tolerance);
      }
      if (repeat) point.status = repeat === 1 ? "settled" : `period ${repeat}`;
      const last = Math.max(1, repeat);
      point.H = meanResponse(H.slice(-last));
      point.harmonics = instance.get(HARMONICS);
      point.loss = (dissipated.at(-1) - dissipated.at(-1 - last)) / last;
    } catch (error) {
      if (!(error instanceof StepDiscarded)) throw error;
      point.status = `failed: ${error.message}`;
      this.moves = false;
    }
    [point.periods] = instance.get(["bench.periods"]);
    [point.steps, point.iterations, point.refinements] = instance.get(COUNTERS).map((now, i) => now - before[i]);
    return point;
  }

  /** One more period, as rows of these variables at the ends of its internal steps; two last steps from where it is. */
  watch(names) {
    const [count] = this.instance.get(["bench.steps_per_period"]);
    const size = 1 / (this.frequency * count), rows = [], values = this.instance.reals(names);
    for (let i = 0; i < count; ++i) {
      this.instance.step(this.time + i * size, size);
      rows.push(Array.from(values.get()));
    }
    this.time += count * size;
    values.free();
    return rows;
  }
}

/** Points of one amplitude, upward in frequency without stopping; those beyond the stroke are left out. */
export function* sweep(instance, parameters, acceleration, frequencies, tolerance) {
  const bench = new Bench(instance, parameters);
  for (const frequency of frequencies)
    if (displacementOf(acceleration, frequency) <= STROKE) yield bench.measure(frequency, acceleration, tolerance);
}
