// Lines on a canvas: linear or logarithmic axes, ticks, a legend with line styles, and the pointer's place in data.

const PAD = { left: 62, right: 12, top: 10, bottom: 40 };
export const COLORS = ["#440154", "#414487", "#2a788e", "#22a884", "#7ad151", "#d0a000"]; // from small to large
export const DASHES = { solid: [], dashed: [6, 4], dotted: [2, 3] };

/** Round ticks from low to high, about `count`; powers of ten with 2 and 5 where logarithmic. */
export function ticks(low, high, count, log) {
  if (log) {
    const found = [];
    for (let e = Math.floor(Math.log10(low)); e <= Math.log10(high); ++e)
      for (const m of [1, 2, 5]) if (m * 10 ** e >= low * 0.999 && m * 10 ** e <= high * 1.001) found.push(m * 10 ** e);
    return found;
  }
  const raw = (high - low) / count, power = 10 ** Math.floor(Math.log10(raw));
  const step = power * [1, 2, 5, 10].find((m) => m * power >= raw);
  const first = Math.ceil(low / step - 1e-9);
  return Array.from({ length: Math.floor(high / step + 1e-9) - first + 1 }, (_, i) => (first + i) * step);
}

export const shown = (value) => String(Number(value.toPrecision(6)));

export class Plot {
  /** options: {x: label, y: label, logY, legend: "left" or none, onPoint(nearest curve, index in it, whether clicked)} */
  constructor(canvas, options) {
    this.canvas = canvas;
    this.options = options;
    this.curves = [];
    if (options.onPoint) {
      canvas.addEventListener("pointermove", (event) => this.point(event, false));
      canvas.addEventListener("click", (event) => this.point(event, true));
    }
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  /** curves: [{x, y, color, dash, width, label, dots}]; x and y arrays, null in y is a gap; limits: {x, y} or none. */
  show(curves, limits = {}, mark = null) {
    Object.assign(this, { curves, limits, mark });
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
      return key === "x" ? [low, high > low ? high : low + 1] : [low - more, high + more];
    };
    const [x0, x1] = range("x", false), [y0, y1] = range("y", options.logY);
    const w = width - PAD.left - PAD.right, h = height - PAD.top - PAD.bottom;
    const scale = options.logY ? Math.log : (value) => value;
    this.px = (x) => PAD.left + (w * (x - x0)) / (x1 - x0);
    this.py = (y) => PAD.top + h - (h * (scale(y) - scale(y0))) / (scale(y1) - scale(y0));
    this.back = (px) => x0 + ((px - PAD.left) / w) * (x1 - x0);
    c.strokeStyle = "#ddd";
    c.fillStyle = "#222";
    c.lineWidth = 1;
    c.textAlign = "center";
    c.beginPath();
    for (const x of ticks(x0, x1, w / 70, false)) {
      c.moveTo(this.px(x), PAD.top);
      c.lineTo(this.px(x), PAD.top + h);
      c.fillText(shown(x), this.px(x), PAD.top + h + 15);
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
    c.translate(12, PAD.top + h / 2);
    c.rotate(-Math.PI / 2);
    c.fillText(options.y, 0, 0);
    c.restore();
    c.save();
    c.beginPath();
    c.rect(PAD.left, PAD.top, w, h);
    c.clip();
    for (const curve of this.curves) this.line(c, curve);
    if (this.mark) {
      c.fillStyle = "#c00";
      c.beginPath();
      c.arc(this.px(this.mark[0]), this.py(this.mark[1]), 5, 0, 7);
      c.fill();
    }
    c.restore();
    this.legend(c, width);
  }

  line(c, { x, y, color, dash = [], width = 1.6, dots }) {
    c.strokeStyle = c.fillStyle = color;
    c.lineWidth = width;
    c.setLineDash(dash);
    c.beginPath();
    let on = false;
    for (let i = 0; i < x.length; ++i) {
      if (!Number.isFinite(y[i])) {
        on = false;
        continue;
      }
      if (dots) {
        c.moveTo(this.px(x[i]) + 3, this.py(y[i]));
        c.arc(this.px(x[i]), this.py(y[i]), 3, 0, 7);
      } else if (on) c.lineTo(this.px(x[i]), this.py(y[i]));
      else c.moveTo(this.px(x[i]), this.py(y[i]));
      on = true;
    }
    c.stroke();
    c.setLineDash([]);
  }

  legend(c, width) {
    const named = this.curves.filter((curve) => curve.label);
    if (!named.length) return;
    const wide = Math.max(...named.map((curve) => c.measureText(curve.label).width)) + 44;
    const left = this.options.legend === "left" ? PAD.left + 4 : width - PAD.right - wide - 4;
    c.fillStyle = "#ffffffd8";
    c.fillRect(left, PAD.top + 4, wide, 16 * named.length + 4);
    c.textAlign = "left";
    named.forEach((curve, i) => {
      const y = PAD.top + 14 + 16 * i;
      c.strokeStyle = curve.color;
      c.lineWidth = curve.width ?? 1.6;
      c.setLineDash(curve.dash ?? []);
      c.beginPath();
      if (curve.dots) c.arc(left + 18, y, 3, 0, 7);
      else {
        c.moveTo(left + 5, y);
        c.lineTo(left + 32, y);
      }
      c.stroke();
      c.setLineDash([]);
      c.fillStyle = "#222";
      c.fillText(curve.label, left + 38, y + 4);
    });
  }

  point(event, chosen) {
    const box = this.canvas.getBoundingClientRect();
    const px = event.clientX - box.left, py = event.clientY - box.top;
    if (!this.px || (!chosen && event.pointerType === "touch")) return;
    let best = null;
    this.curves.forEach((curve, index) =>
      curve.x.forEach((x, i) => {
        if (curve.passive || !Number.isFinite(curve.y[i])) return;
        const far = Math.hypot(this.px(x) - px, this.py(curve.y[i]) - py);
        if (!best || far < best.far) best = { far, index, i };
      }),
    );
    if (best) this.options.onPoint(this.curves[best.index], best.i, chosen);
  }
}
