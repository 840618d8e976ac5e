// The part of a series below a band's edge, as zspring/line/statistics.py takes it: a Butterworth low-pass of order 4, run
// forwards and backwards over the series, which is continued by point reflection.

const SETTLING = 1, SETTLING_PERIODS = 5; // s, or periods of the band's edge

/** Two sections of second order, {b, a} with a[0] = 1, by the bilinear transform with the edge kept. */
function sections(cutoff, step) {
  const warped = Math.tan(Math.PI * cutoff * step);
  return [1, 3].map((n) => {
    const damping = 2 * Math.sin((n * Math.PI) / 8); // poles of order 4
    const scale = 1 + damping * warped + warped ** 2, gain = warped ** 2 / scale;
    return {
      b: [gain, 2 * gain, gain],
      a: [1, (2 * (warped ** 2 - 1)) / scale, (1 - damping * warped + warped ** 2) / scale],
    };
  });
}

/** One way through all sections, from the rest that belongs to the first value. */
function through(values, filters) {
  let series = values;
  for (const { b, a } of filters) {
    const first = series[0];
    let z2 = (b[2] - a[2]) * first, z1 = (b[1] - a[1]) * first + z2;
    series = series.map((x) => {
      const y = b[0] * x + z1;
      z1 = b[1] * x - a[1] * y + z2;
      z2 = b[2] * x - a[2] * y;
      return y;
    });
  }
  return series;
}

/** Samples `step` s apart without what is above `cutoff` Hz. */
export function lowPass(series, step, cutoff) {
  const n = series.length;
  const more = Math.min(n - 1, Math.round(Math.max(SETTLING, SETTLING_PERIODS / cutoff) / step));
  const before = Array.from({ length: more }, (_, i) => 2 * series[0] - series[more - i]);
  const behind = Array.from({ length: more }, (_, i) => 2 * series[n - 1] - series[n - 2 - i]);
  const filters = sections(cutoff, step);
  const forwards = through([...before, ...series, ...behind], filters);
  return through(forwards.reverse(), filters).reverse().slice(more, more + n);
}

/** {mean, deviation, maximum, minimum in N of 0 to 20 Hz; lost: % of the time} of forces at these places. */
export function statistics(forces, step, inside) {
  const kept = lowPass(forces, step, 20).filter((_, i) => inside(i));
  const mean = kept.reduce((sum, force) => sum + force, 0) / kept.length;
  const deviation = Math.sqrt(kept.reduce((sum, force) => sum + (force - mean) ** 2, 0) / kept.length);
  const raw = forces.filter((_, i) => inside(i));
  const lost = (100 * raw.filter((force) => force <= 0).length) / raw.length;
  return { mean, deviation, maximum: Math.max(...kept), minimum: Math.min(...kept), lost };
}
