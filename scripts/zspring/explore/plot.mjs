// Lines on a canvas: linear or logarithmic axes, ticks, a legend with line styles, and the value under the pointer.

const PAD = { left: 62, right: 14, bottom: 40 };
const ROW = 18, NEAR = 30; // px: a row of the legend; how near the pointer must be
const COLORS = ["#440154", "#414487", "#2a788e", "#1f9673", "#5f9e1a", "#b58600", "#c4500c", "#a3105c"];
/** So many colors, from small to large. */
export const colors = (count) => Array.from({ length: count }, (_, i) => COLORS[count < 2 ? 0 : Math.round((i * (COLORS.length - 1)) / (count - 1)) % COLORS.length]);
export const DASHES = { solid: [], dashed: [6, 4], dotted: [2, 3] };

/** Round ticks from low to high, about `count`; powers of ten with 2 and 5 where logarithmic. */
export function ticks(low, high, count, log) {
  if (log) {
    const found = [];
    for (let e = Math.floor(Math.log10(low)); e <= Math.log10(high); ++e)
      for (const m of [1, 2, 5]) if (m * 10 ** e >= low * 0.999 && m * 10 ** e <= high * 1.001) found.push(m * 10 ** e);
    if (found.length > 1) return found;
  }
  const raw = (high - low) / count, power = 10 ** Math.floor(Math.log10(raw));
  const step = power * [1, 2, 5, 10].find((m) => m * power >= raw);
  const first = Math.ceil(low / step - 1e-9);
  return Array.from({ length: Math.floor(high / step + 1e-9) - first + 1 }, (_, i) => (first + i) * step);
}

export const shown = (value) => String(Number(value.toPrecision(6)));

export class Plot {
  /** options: {x: label, y: label, logY, room: beside closed curves, onPoint(curve, index): a click, onKey(key): an arrow} */
  constructor(canvas, options) {
    Object.assign(this, { canvas, options, curves: [], hover: null });
    canvas.addEventListener("pointermove", (event) => this.over(event.pointerType === "touch" ? null : this.nearest(event)));
    canvas.addEventListener("pointerleave", () => this.over(null));
    canvas.addEventListener("click", (event) => {
      const found = this.nearest(event, (curve) => !curve.passive);
      if (found) options.onPoint?.(found.curve, found.i);
    });
    if (options.onKey) {
      canvas.tabIndex = 0;
      canvas.addEventListener("keydown", (event) => {
        if (!event.key.startsWith("Arrow")) return;
        event.preventDefault();
        options.onKey(event.key);
      });
    }
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  /**
   * curves: [{x, y, color, dash, width, label, bad, dots}]; x and y arrays, NaN in y is a gap; bad: places that are crossed
   * out; dots: "ring", "full" or "cross", no line; passive: not to be clicked; limits: {x, y} or none.
   */
  show(curves, limits = {}, mark = null) {
    Object.assign(this, { curves, limits, mark, hover: null });
    this.draw();
  }

  draw() {
    const { canvas, options } = this;
    const width = canvas.clientWidth, height = canvas.clientHeight, ratio = window.devicePixelRatio || 1;
    if (!width || !height) return;
    [canvas.width, canvas.height] = [width * ratio, height * ratio];
    const c = canvas.getContext("2d");
    c.scale(ratio, ratio);
    c.font = "12px system-ui, sans-serif";
    c.fillStyle = "#fff";
    c.fillRect(0, 0, width, height);
    const values = (key) => this.curves.flatMap((curve) => Array.from(curve[key])).filter(Number.isFinite);
    const range = (key, log) => {
      if (this.limits?.[key]) return this.limits[key];
      const all = values(key).filter((value) => !log || value > 0);
      if (!all.length) return log ? [0.1, 1] : [0, 1];
      const low = all.reduce((a, b) => Math.min(a, b)), high = all.reduce((a, b) => Math.max(a, b));
      if (log) return [low / 1.1, high * 1.1];
      const more = 0.04 * (high - low || Math.abs(high) || 1);
      return key === "x" && !options.room ? [low, high > low ? high : low + 1] : [low - more, high + more];
    };
    this.px = null;
    if (!values("x").length) return;
    const [x0, x1] = range("x", false), [y0, y1] = range("y", options.logY);
    const entries = this.entries(c, width - PAD.left - PAD.right), top = 10 + ROW * entries.rows;
    const w = width - PAD.left - PAD.right, h = height - top - PAD.bottom;
    const scale = options.logY ? Math.log : (value) => value;
    this.px = (x) => PAD.left + (w * (x - x0)) / (x1 - x0);
    this.py = (y) => top + h - (h * (scale(y) - scale(y0))) / (scale(y1) - scale(y0));
    c.strokeStyle = "#ddd";
    c.fillStyle = "#222";
    c.lineWidth = 1;
    c.textAlign = "center";
    c.beginPath();
    for (const x of ticks(x0, x1, Math.max(3, w / 70), false)) {
      c.moveTo(this.px(x), top);
      c.lineTo(this.px(x), top + h);
      c.fillText(shown(x), this.px(x), top + h + 15);
    }
    c.textAlign = "right";
    for (const y of ticks(y0, y1, h / 40, options.logY)) {
      c.moveTo(PAD.left, this.py(y));
      c.lineTo(PAD.left + w, this.py(y));
      c.fillText(shown(y), PAD.left - 5, this.py(y) + 4);
    }
    c.stroke();
    c.textAlign = "center";
    c.fillText(options.x, PAD.left + w / 2, height - 6);
    c.save();
    c.translate(12, top + h / 2);
    c.rotate(-Math.PI / 2);
    c.fillText(options.y, 0, 0);
    c.restore();
    c.save();
    c.beginPath();
    c.rect(PAD.left, top, w, h);
    c.clip();
    for (const curve of this.curves) this.line(c, curve);
    if (this.mark) {
      c.fillStyle = "#c00";
      c.beginPath();
      c.arc(this.px(this.mark[0]), this.py(this.mark[1]), 5, 0, 7);
      c.fill();
    }
    c.restore();
    this.legend(c, entries.places);
    if (this.hover) this.tell(c, width);
  }

  line(c, { x, y, color, dash = [], width = 1.6, dots, bad = [] }) {
    c.strokeStyle = c.fillStyle = color;
    c.lineWidth = width;
    c.setLineDash(dash);
    c.beginPath();
    let on = false;
    for (let i = 0; i < x.length; ++i) {
      if (!Number.isFinite(y[i])) on = false;
      else if (dots) this.dot(c, dots, this.px(x[i]), this.py(y[i]));
      else if (on) c.lineTo(this.px(x[i]), this.py(y[i]));
      else c.moveTo(this.px(x[i]), this.py(y[i]));
      on = Number.isFinite(y[i]);
    }
    c.stroke();
    if (dots === "full") c.fill();
    c.setLineDash([]);
    c.beginPath();
    for (const i of bad) if (Number.isFinite(y[i])) this.dot(c, "cross", this.px(x[i]), this.py(y[i]));
    c.stroke();
  }

  dot(c, kind, px, py) {
    if (kind === "cross") {
      c.moveTo(px - 4, py - 4);
      c.lineTo(px + 4, py + 4);
      c.moveTo(px - 4, py + 4);
      c.lineTo(px + 4, py - 4);
    } else {
      c.moveTo(px + 3.5, py);
      c.arc(px, py, 3.5, 0, 7);
    }
  }

  /** Rows of the legend, above the curves, and where its entries are. */
  entries(c, width) {
    let left = 0, row = 0;
    const places = this.curves.filter((curve) => curve.label).map((curve) => {
      const wide = 36 + c.measureText(curve.label).width + 16;
      if (left && left + wide > width) [left, row] = [0, row + 1];
      left += wide;
      return { curve, x: PAD.left + left - wide, y: 14 + ROW * row };
    });
    return { places, rows: places.length ? row + 1 : 0 };
  }

  legend(c, places) {
    c.textAlign = "left";
    for (const { curve, x, y } of places) {
      c.strokeStyle = c.fillStyle = curve.color;
      c.lineWidth = curve.width ?? 1.6;
      c.setLineDash(curve.dash ?? []);
      c.beginPath();
      if (curve.dots) this.dot(c, curve.dots, x + 20, y);
      else {
        c.moveTo(x, y);
        c.lineTo(x + 30, y);
      }
      c.stroke();
      if (curve.dots === "full") c.fill();
      c.setLineDash([]);
      c.fillStyle = "#222";
      c.fillText(curve.label, x + 36, y + 4);
    }
  }

  /** The value under the pointer. */
  tell(c, width) {
    const { curve, i } = this.hover, px = this.px(curve.x[i]), py = this.py(curve.y[i]);
    const unit = (axis) => this.options[axis].match(/\[(.*)\]/)?.[1] ?? "";
    const text = `${curve.told ?? curve.label}${curve.label || curve.told ? ":  " : ""}${shown(curve.x[i])} ${unit("x")},  ${Number(curve.y[i].toPrecision(4))} ${unit("y")}`;
    const wide = c.measureText(text).width + 12, left = Math.min(Math.max(px + 10, PAD.left), width - wide - 4);
    c.strokeStyle = "#222";
    c.lineWidth = 1.5;
    c.beginPath();
    c.arc(px, py, 5, 0, 7);
    c.stroke();
    c.fillStyle = "#fffffff0";
    c.fillRect(left, py - 30, wide, 20);
    c.strokeRect(left, py - 30, wide, 20);
    c.fillStyle = "#222";
    c.textAlign = "left";
    c.fillText(text, left + 6, py - 16);
  }

  over(found) {
    if (found?.curve === this.hover?.curve && found?.i === this.hover?.i) return;
    this.hover = found;
    this.draw();
  }

  /** The point of a curve that is near the pointer, {curve, i}, or null. */
  nearest(event, wanted = () => true) {
    if (!this.px) return null;
    const box = this.canvas.getBoundingClientRect(), px = event.clientX - box.left, py = event.clientY - box.top;
    let best = null, least = NEAR;
    for (const curve of this.curves) {
      if (!wanted(curve)) continue;
      for (let i = 0; i < curve.x.length; ++i) {
        const far = Math.hypot(this.px(curve.x[i]) - px, this.py(curve.y[i]) - py);
        if (far < least) [least, best] = [far, { curve, i }];
      }
    }
    return best;
  }
}

/** Curves as they are drawn below the next ones; what: the parameters that they are of, told once. */
export const pale = (curves, what) =>
  curves.map((curve, i) => ({ ...curve, color: `${curve.color.padEnd(7, curve.color.slice(1))}60`, width: 4, bad: [], label: i ? "" : `pinned: ${what}`, told: `pinned, ${curve.label}`, passive: true }));
