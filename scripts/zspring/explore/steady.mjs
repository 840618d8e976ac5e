// When a response is steady: zspring/bench/steady.py, which has the theory, for the page. Complex numbers are [re, im].

const LOOK = 4; // periods between two looks at the criterion
const MOST_REPEAT = 4;
const ORDER = 6, LEAST_ORDER = 3;
const WINDOW = 16;
const CLEAR = 10;
const NEGLIGIBLE = 1e-10; // singular values, of the largest
const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);
const size = (a) => Math.hypot(...a);

/** Least x with least |A x - b|, A by columns, by its singular values (one-sided Jacobi rotations). */
export function leastSquares(columns, b) {
  const U = columns.map((column) => [...column]);
  const n = U.length;
  const V = U.map((_, i) => U.map((_, j) => Number(i === j)));
  const dot = (x, y) => x.reduce((sum, value, i) => sum + value * y[i], 0);
  for (let sweep = 0, turned = true; turned && sweep < 60; ++sweep) {
    turned = false;
    for (let p = 0; p < n - 1; ++p)
      for (let q = p + 1; q < n; ++q) {
        const a = dot(U[p], U[p]), d = dot(U[q], U[q]), c = dot(U[p], U[q]);
        if (Math.abs(c) <= 1e-15 * Math.sqrt(a * d)) continue;
        turned = true;
        const zeta = (d - a) / (2 * c);
        const t = (Math.sign(zeta) || 1) / (Math.abs(zeta) + Math.hypot(1, zeta));
        const cosine = 1 / Math.hypot(1, t), sine = t * cosine;
        for (const M of [U, V])
          for (let i = 0; i < M[p].length; ++i)
            [M[p][i], M[q][i]] = [cosine * M[p][i] - sine * M[q][i], sine * M[p][i] + cosine * M[q][i]];
      }
  }
  const squares = U.map((column) => dot(column, column));
  const least = NEGLIGIBLE ** 2 * Math.max(...squares);
  const x = new Array(n).fill(0);
  squares.forEach((square, k) => {
    if (square <= least) return;
    const part = dot(U[k], b) / square;
    for (let i = 0; i < n; ++i) x[i] += V[k][i] * part;
  });
  return x;
}

/** Where the last k values lead if only every k-th period is seen; null for too few. */
function limit(H, k) {
  const count = Math.min(Math.floor(H.length / k), WINDOW);
  const order = Math.min(ORDER, Math.floor(count / 2) - 1);
  if (order < LEAST_ORDER) return null;
  const values = Array.from({ length: count }, (_, i) => {
    const start = H.length - count * k + i * k;
    const block = H.slice(start, start + k);
    return [...block.map(([re]) => re), ...block.map(([, im]) => im)];
  });
  const differences = values.slice(1).map((row, i) => row.map((value, j) => value - values[i][j]));
  const rows = count - 1 - order;
  const windows = Array.from({ length: order + 1 }, (_, i) => differences.slice(i, i + rows).flat());
  const last = windows[order];
  const weights = leastSquares(
    windows.slice(0, -1).map((window) => window.map((value, j) => value - last[j])),
    last.map((value) => -value),
  );
  weights.push(1 - weights.reduce((sum, weight) => sum + weight, 0));
  const blocks = values.slice(-order - 1);
  const mean = (j) => blocks.reduce((sum, block, i) => sum + weights[i] * block[j], 0);
  return Array.from({ length: k }, (_, j) => [mean(j), mean(k + j)]);
}

function left(H, steady) {
  if (!steady) return Infinity;
  const last = H.slice(-steady.length);
  const most = Math.max(...steady.map((value, i) => distance(value, last[i])));
  const scale = size(H.at(-1));
  return scale && Number.isFinite(most) ? most / scale : Infinity;
}

/** [the fewest periods after which H repeats within the tolerance or 0, how far it is from its limit]. */
export function repeatsAfter(H, tolerance) {
  for (let k = 1; k <= MOST_REPEAT; ++k) {
    if (H.length <= LOOK * k) continue;
    const end = H.length - 1;
    const allowed = tolerance * size(H[end]);
    const change = Math.max(distance(H[end], H[end - k]), distance(H[end], H[end - LOOK * k]));
    if (!(change <= allowed)) continue;
    const steady = limit(H, k), rest = left(H, steady);
    if (!(rest <= tolerance)) continue;
    const clear = Math.max(allowed, CLEAR * rest * size(H[end]));
    const stays = (fewer) =>
      Math.max(...steady.map((value, i) => distance(value, steady[(i + k - fewer) % k]))) > clear;
    if (Array.from({ length: k - 1 }, (_, i) => i + 1).every(stays)) return [k, rest];
  }
  return [0, left(H, limit(H, 1))];
}

/** H of all these periods together: of forces, thus of 1/H, the mean. */
export function meanResponse(H) {
  if (H.length === 1) return H[0];
  const inverse = ([re, im]) => [re / (re * re + im * im), -im / (re * re + im * im)];
  const sum = H.map(inverse).reduce(([a, b], [c, d]) => [a + c, b + d]);
  return inverse([sum[0] / H.length, sum[1] / H.length]);
}
