// Stick and slip of the rods at one frequency, as zspring/bench/slip.py has it: the amplitude is raised from rest.

import { Bench, displacementOf, STROKE } from "./bench.mjs";

const SLIDES = 0.95, FULL = 0.9; // of Mf, and of the period
const MOMENTS = ["zspring.moment_alpha", "zspring.moment_beta"];

/** [{frequency, amplitude, state: "stick", "partial slip", "full slip", or "" where it failed}]. */
export function raised(instance, parameters, frequency, amplitudes) {
  const bench = new Bench(instance, parameters), found = [];
  for (const amplitude of amplitudes) {
    if (displacementOf(amplitude, frequency) > STROKE) break;
    const point = bench.measure(frequency, amplitude);
    let state = "";
    if (point.H) {
      const [bound] = instance.get(["zspring.Mf"]);
      const shares = bench.watch(MOMENTS).map((row) => row.map((moment) => Math.abs(moment) / bound));
      const sliding = [0, 1].map((i) => shares.filter((row) => row[i] >= SLIDES).length / shares.length);
      const most = Math.max(...shares.flat());
      state = most < SLIDES ? "stick" : Math.min(...sliding) >= FULL ? "full slip" : "partial slip";
    }
    found.push({ frequency, amplitude, state });
  }
  return found;
}
