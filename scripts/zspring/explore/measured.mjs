// Measured frequency responses from CSV files, as zspring/bench/measured.py reads them, as far as the page draws them.

const REMARK = /^#|^\s*$/;
const TURN = 2 * Math.PI;
const FREQUENCY = { hz: 1, khz: 1e3, "rad/s": 1 / TURN, rpm: 1 / 60, "1/min": 1 / 60 }; // to Hz
const G = 9.80665;
const MOTION = { m: [1, 0], mm: [1e-3, 0], um: [1e-6, 0], "m/s": [1, 1], "mm/s": [1e-3, 1], "m/s2": [1, 2], "mm/s2": [1e-3, 2], g: [G, 2] }; // to SI, derivatives
const FORCE = { N: 1, kN: 1e3 };
const ANGLE = { deg: 1, "°": 1, rad: 360 / TURN }; // to degrees
const APART = 0.25; // of the logarithm, between amplitudes of different levels
const MOST_LEVELS = 12;

const plain = (unit) => unit.replace(/[\s()^]/g, "").replace(/²/g, "2").replace(/[µμ]/g, "u").replace(/[·*]/g, ".");

/**
 * Of a unit of response: |H| in m/N from a value and the angular frequency, as a function with the member `turned`, which
 * makes the phase of H in degrees of that of the response; null for another unit.
 */
function receptance(unit) {
  const text = plain(unit), made = (of, sign, derivatives) => Object.assign(of, { turned: (phase) => sign * phase - 90 * derivatives });
  for (const [motion, [factor, derivatives]] of Object.entries(MOTION))
    for (const [force, newtons] of Object.entries(FORCE)) {
      const forms = [`${motion}/${force}`, motion.startsWith("m/s") && force === "N" ? motion.replace("/", `/${force}/`) : ""];
      if (forms.includes(text)) return made((value, omega) => ((factor / newtons) * value) / omega ** derivatives, 1, derivatives);
      const inverse = [`${force}/${motion}`, derivatives === 1 ? `${force}.s/${motion.slice(0, -2)}` : derivatives === 2 ? `${force}.s2/${motion.slice(0, -3)}` : ""];
      if (inverse.includes(text)) return made((value, omega) => ((newtons / factor) * value) ** -1 / omega ** derivatives, -1, derivatives);
    }
  if (text === "1/kg") return receptance("m/s2/N");
  return text === "kg" ? receptance("N/m/s2") : null;
}

/** Rows {cells, number} of a table and its columns by name {place, unit}: separators , ; and tab, decimal commas. */
function table(text) {
  const lines = text.split(/\r\n|\n|\r/).map((content, i) => ({ content, number: i + 1 })).filter(({ content }) => !REMARK.test(content));
  if (!lines.length) throw new Error("has no table");
  const separator = ["\t", ";", ","].find((one) => lines[0].content.includes(one)) ?? ",";
  const [titles, ...rows] = lines.map(({ content, number }) => ({ cells: content.split(separator).map((cell) => cell.trim().replace(/^"(.*)"$/, "$1")), number }));
  for (const { cells, number } of rows)
    if (cells.length !== titles.cells.length) throw new Error(`line ${number}: has ${cells.length} cells, the head has ${titles.cells.length}`);
  const below = rows[0]?.cells.every((cell) => !/^[-+.\d]/.test(cell) || cell === "1/kg") ? rows.shift().cells : []; // a line of units
  const columns = new Map();
  titles.cells.forEach((title, place) => {
    const [, name, square, round] = title.match(/^(.*?)\s*(?:\[(.*)\]|\((.*)\))?$/);
    const known = name.toLowerCase().replaceAll("_", " ").replace(/^h re$/, "real").replace(/^h im$|^imag$/, "imaginary");
    if (columns.has(known)) throw new Error(`has two columns ${known}`);
    columns.set(known, { place, unit: (square ?? round ?? below[place] ?? "").trim() });
  });
  return { rows, columns, comma: separator !== "," };
}

function groups(points, key) {
  const found = new Map();
  for (const point of points) found.set(point[key], [...(found.get(point[key]) ?? []), point]);
  return found;
}

const spread = (some, value) => Math.log(value(some.at(-1)) / value(some[0]));

/**
 * Points in groups of one amplitude {label, acceleration: m/s2 or NaN, some}: as their texts have it, else by gaps between
 * amplitudes of the acceleration, velocity or displacement, whichever is steady.
 */
function levels(points, unit, [factor, derivatives]) {
  const same = groups(points, "amplitude");
  if (same.size <= MOST_LEVELS && [...same.values()].every((some) => some.length > 1 || points.length === 1))
    return [...same].map(([amplitude, some]) => ({ label: `${amplitude} ${unit}`, acceleration: derivatives === 2 ? Number((factor * amplitude).toPrecision(6)) : NaN, some }));
  let best = null;
  for (const kind of [derivatives, 2, 1, 0]) {
    const value = ({ amplitude, frequency }) => factor * amplitude * (TURN * frequency) ** (kind - derivatives);
    const sorted = [...points].sort((a, b) => value(a) - value(b)), apart = [];
    sorted.forEach((point, i) => {
      if (!i || spread([sorted[i - 1], point], value) > APART) apart.push([]);
      apart.at(-1).push(point);
    });
    if (apart.length > (best?.length ?? MOST_LEVELS + 1) - 1 || apart.some((some) => spread(some, value) > 2 * APART)) continue;
    best = apart.map((some) => {
      const middle = Number(value(some[some.length >> 1]).toPrecision(3));
      return { label: `about ${middle} ${["m", "m/s", "m/s2"][kind]}`, acceleration: kind === 2 ? middle : NaN, some: points.filter((point) => some.includes(point)) };
    });
  }
  return best ?? [{ label: "at amplitudes that vary", acceleration: NaN, some: points }];
}

/**
 * Curves {label, acceleration: nominal in m/s2 or NaN, x: Hz, y: |H| in m/N, phase: degrees, NaN where it is not told} by
 * amplitude of a measured FRF's CSV. Throws Error with the line.
 */
export function readMeasured(text) {
  const { rows, columns, comma } = table(text);
  const column = (name) => {
    if (!columns.has(name)) throw new Error(`has no column ${name}`);
    return columns.get(name);
  };
  const toHertz = FREQUENCY[plain(column("frequency").unit).toLowerCase()];
  if (!toHertz) throw new Error(`column frequency: unit [${column("frequency").unit}]: must be Hz, kHz, rad/s or rpm`);
  const parts = columns.has("real") || columns.has("imaginary") ? ["real", "imaginary"] : ["magnitude"];
  const units = new Set(parts.map((part) => column(part).unit)), [unit] = units;
  const toReceptance = receptance(unit);
  if (units.size > 1) throw new Error(`column imaginary: unit [${column("imaginary").unit}]: must be ${unit}`);
  if (!toReceptance) throw new Error(`column ${parts[0]}: unit [${unit}]: must be that of motion over force or its inverse, as m/N`);
  const amplitude = columns.get("amplitude"), level = columns.get("level"), status = columns.get("status");
  const motion = amplitude && MOTION[plain(amplitude.unit)];
  if (amplitude && !motion) throw new Error(`column amplitude: unit [${amplitude.unit}]: must be that of a motion, as m/s2 or mm`);
  const told = parts.length === 1 && columns.get("phase"), toDegrees = told && ANGLE[plain(told.unit)];
  if (told && !toDegrees) throw new Error(`column phase: unit [${told.unit}]: must be deg or rad`);
  const points = [];
  for (const { cells, number } of rows) {
    if (status && /^(left out|failed)/.test(cells[status.place])) continue;
    const numberAt = (what, positive) => {
      const cell = cells[column(what).place], dotted = comma && !cell.includes(".") ? cell.replace(",", ".") : cell;
      const value = cell === "" ? NaN : Number(dotted);
      if (!Number.isFinite(value)) throw new Error(`line ${number}, column ${what}: "${cell}" is no finite number`);
      if (positive && !(value > 0)) throw new Error(`line ${number}, column ${what}: ${cell}: must be more than 0`);
      return value;
    };
    const frequency = toHertz * numberAt("frequency", true), omega = TURN * frequency;
    const values = parts.map((part) => numberAt(part, part === "magnitude")), size = Math.hypot(...values);
    const angle = told ? toDegrees * numberAt("phase") : parts.length > 1 ? (360 / TURN) * Math.atan2(values[1], values[0]) : NaN;
    if (!size) throw new Error(`line ${number}: the response is 0`);
    points.push({ frequency, H: toReceptance(size, omega), phase: toReceptance.turned(angle), amplitude: amplitude ? numberAt("amplitude", true) : NaN, level: level && cells[level.place] });
  }
  if (!points.length) throw new Error("has no row with a measured point");
  const median = (some) => some.map((point) => point.amplitude).sort((a, b) => a - b)[some.length >> 1];
  const known = (some) => (motion?.[1] === 2 ? Number((motion[0] * median(some)).toPrecision(3)) : NaN);
  const found = level ? [...groups(points, "level")].map(([label, some]) => ({ label, acceleration: known(some), some }))
    : amplitude ? levels(points, amplitude.unit, motion) : [{ label: "", acceleration: NaN, some: points }];
  return found.map(({ label, acceleration, some }) => ({ label, acceleration, x: some.map((point) => point.frequency), y: some.map((point) => point.H), phase: some.map((point) => point.phase) }));
}

/** What the head of a file says of its bench that is other there than what the page has: lines of text. */
export function otherThan(text, { static_force, friction }) {
  const stated = Object.fromEntries([...text.matchAll(/^# (static_force|friction|direction): (.*?)\s*$/gm)].map(([, name, value]) => [name, value]));
  const here = { static_force: `${static_force} N`, friction, direction: "up" };
  const same = (name) => stated[name] === here[name] || (name === "static_force" && /^[-+.\de]+ N$/.test(stated[name]) && parseFloat(stated[name]) === static_force);
  return Object.keys(stated).filter((name) => !same(name)).map((name) => `${name} ${stated[name]}, here ${here[name]}`);
}

/** Text of a file's bytes: UTF-8, UTF-16 with its mark, else Windows-1252. */
export function decoded(bytes) {
  const [first, second] = bytes;
  if ((first === 0xff && second === 0xfe) || (first === 0xfe && second === 0xff)) return new TextDecoder(first === 0xff ? "utf-16le" : "utf-16be").decode(bytes);
  try {
    return new TextDecoder("utf-8", { fatal: true }).decode(bytes);
  } catch {
    return new TextDecoder("windows-1252").decode(bytes);
  }
}
