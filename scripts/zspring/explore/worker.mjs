// Computes for the page, off its thread: each message is a job by name, answered under its number.

import { Bench, sweep } from "./bench.mjs";
import { readDescription } from "./description.mjs";
import { Fmu } from "./fmi2.mjs";
import { LineRun } from "./line.mjs";
import { raised } from "./slip.mjs";
import { staticLoop } from "./static.mjs";

const OF_CYCLE = ["head.z", "upper_frame.z", "contact.force", "zspring.alpha", "zspring.beta"];
const MOMENTS = ["zspring.moment_alpha", "zspring.moment_beta"];
const POINTS = 8; // of the wire that the catenary tells at a time
const HALF_WINDOW = 65, APART = 1; // m about the pantograph, and between places of the wire's shape
const FRAME = 0.02; // s between two pictures

const fmus = {};
const instances = {};
const instance = (model) => (instances[model] ??= fmus[model].instantiate());

/** Heights of contact wire, messenger and nearest dropper at places along the line, from moved points. */
function shape(catenary, places) {
  const wire = [], messenger = [], droppers = new Map();
  for (let begin = 0; begin < places.length; begin += POINTS) {
    const some = places.slice(begin, begin + POINTS);
    const names = (kind) => some.map((_, i) => `point.${kind}[${i + 1}]`);
    catenary.set(Object.fromEntries(names("position").map((name, i) => [name, some[i]])));
    wire.push(...catenary.get(names("height")));
    messenger.push(...catenary.get(names("messenger_height")));
    const at = catenary.get(names("dropper_position")), force = catenary.get(names("dropper_force"));
    at.forEach((place, i) => droppers.set(place, force[i]));
  }
  return { places, wire, messenger, droppers: [...droppers] };
}

const jobs = {
  async load({ models }) {
    for (const [model, { bytes, description }] of Object.entries(models))
      fmus[model] = await Fmu.load(bytes, readDescription(description));
  },

  sweep: ({ parameters, amplitude, frequencies }) => [
    ...sweep(instance("ZSpringPantograph"), parameters, amplitude, frequencies),
  ],

  /** A settled point and the outputs over one more period, in rows {names, rows}. */
  cycle({ parameters, amplitude, frequency }) {
    const bench = new Bench(instance("ZSpringPantograph"), parameters);
    const point = bench.measure(frequency, amplitude);
    const names = [...OF_CYCLE, ...MOMENTS];
    const fixed = instance("ZSpringPantograph").get(["zspring.theta", "zspring.L1", "zspring.L2", "zspring.d", "zspring.Mf"]);
    return { point, names, rows: point.H ? bench.watch(names) : [], fixed };
  },

  loop: ({ parameters, amplitude, rate }) => staticLoop(instance("ZSpringPantograph"), parameters, amplitude, rate),

  slip: ({ parameters, frequency, amplitudes }) =>
    raised(instance("ZSpringPantograph"), parameters, frequency, amplitudes),

  /** Whether the FMU takes these values, and what it calculates of them. */
  check({ parameters }) {
    const pantograph = instance("ZSpringPantograph");
    pantograph.start(parameters);
    return pantograph.get(["zspring.k_locked", "zspring.k_free", "zspring.theta"]);
  },

  /**
   * A run to `stop` m: {positions, forces} each step, the largest uplift of a support in m (`lifted`), and frames
   * {row, shape} where they are asked for.
   */
  line({ run, stop, frames }, tell) {
    const catenary = instance("Catenary");
    const coupled = new LineRun(catenary, instance("ZSpringPantograph"), run);
    const told = { positions: [coupled.position], forces: [coupled.force], frames: [], lifted: 0 };
    const names = [...fmus.Catenary.description.variables.keys()].filter((name) => name.startsWith("support.uplift"));
    const supports = catenary.reals(names);
    const often = Math.max(1, Math.round(FRAME / run.step)), length = run.length;
    while (coupled.position < stop) {
      coupled.advance();
      told.positions.push(coupled.position);
      told.forces.push(coupled.force);
      for (const uplift of supports.get()) if (uplift > told.lifted) told.lifted = uplift;
      if (!frames || coupled.steps % often) continue;
      const first = Math.max(0, Math.ceil((coupled.position - HALF_WINDOW) / APART));
      const last = Math.min(Math.floor(length / APART), Math.floor((coupled.position + HALF_WINDOW) / APART));
      const places = Array.from({ length: last - first + 1 }, (_, i) => APART * (first + i));
      told.frames.push({ row: coupled.steps, ...shape(catenary, places) });
      if (told.frames.length % 25 === 0) tell({ position: coupled.position });
    }
    supports.free();
    coupled.free();
    return told;
  },
};

self.onmessage = async ({ data: { number, job, given } }) => {
  try {
    const answer = await jobs[job](given, (progress) => self.postMessage({ number, progress }));
    self.postMessage({ number, answer });
  } catch (error) {
    self.postMessage({ number, error: error.message });
  }
};
