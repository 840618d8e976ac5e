// One slow loop of the head suspension, as zspring/bench/loops.py makes it: clamped frame, head moved to and fro.

const CLAMP = 1e9; // N/m
const POINTS = 400, CYCLES = 3;
const LONGEST_STEP = 0.02; // s

/** {compression in m, force in N beyond the static one}: the last loop, from the largest compression; rate in m/s. */
export function staticLoop(instance, parameters, amplitude, rate) {
  const step = (4 * amplitude) / (rate * POINTS);
  const own = { drive: "Displacement", k2: CLAMP, k3: CLAMP, "solver.step": Math.min(step, LONGEST_STEP) };
  instance.start({ ...parameters, ...own });
  const [mass, staticForce] = instance.get(["m1", "static_force"]);
  const target = instance.reals(["head_displacement"]);
  const outputs = instance.reals(["head.z", "upper_frame.z", "contact.force", "head.a"]);
  const count = CYCLES * POINTS + POINTS / 4, loop = { compression: [], force: [] };
  const triangle = (n) => {
    const phase = (n / POINTS) % 1;
    return -amplitude * (phase < 0.25 ? 4 * phase : phase < 0.75 ? 2 - 4 * phase : 4 * phase - 4);
  };
  for (let i = 0; i < count; ++i) {
    target.set([triangle(i + 1)]); // the head is there at the end of the step, in a straight line
    instance.step(i * step, step);
    if (i < count - POINTS - 1) continue;
    const [head, frame, force, acceleration] = outputs.get();
    loop.compression.push(frame - head);
    loop.force.push(force - staticForce + mass * acceleration);
  }
  for (const reals of [target, outputs]) reals.free();
  return loop;
}
