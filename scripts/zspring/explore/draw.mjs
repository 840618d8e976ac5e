// The linkage and the line, to scale, on a canvas.

function prepared(canvas) {
  const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
  [canvas.width, canvas.height] = [width * ratio, height * ratio];
  const c = canvas.getContext("2d");
  c.scale(ratio, ratio);
  c.fillStyle = "#fff";
  c.fillRect(0, 0, width, height);
  c.font = "12px system-ui, sans-serif";
  return { c, width, height };
}

/**
 * Head, rods and spring, frame; geometry {theta, L1, L2, d} and state {head, frame, alpha, beta} in m and rad, whose
 * motion about the static state has been magnified.
 */
export function drawLinkage(canvas, { theta, L1, L2, d }, { head, frame, alpha, beta }, sliding, magnified) {
  const { c, width, height } = prepared(canvas);
  const gap = d * Math.tan(theta), top = frame + gap;
  const points = [
    [0, head],
    [L1 * Math.cos(alpha), head + L1 * Math.sin(alpha)],
    [d - L2 * Math.cos(beta), top - L2 * Math.sin(beta)],
    [d, top],
  ];
  // One scale for both axes, with room for the static gap and 40 mm of motion to either side.
  const reach = 0.04, low = Math.min(0, gap) - reach, high = Math.max(0, gap) + reach, beside = 0.04;
  const scale = Math.min(width / (d + 2 * beside), (height - 20) / (high - low));
  const x = (m) => width / 2 + scale * (m - d / 2), y = (m) => (height - 20) / 2 - scale * (m - (low + high) / 2);
  const line = (some, color, thick) => {
    c.strokeStyle = color;
    c.lineWidth = thick;
    c.beginPath();
    some.forEach(([a, b], i) => (i ? c.lineTo(x(a), y(b)) : c.moveTo(x(a), y(b))));
    c.stroke();
  };
  line([[-beside * 0.8, head], [0.012, head]], "#333", 9); // head and frame end at their joints: the rods stay free
  line([[d - 0.012, top], [d + beside * 0.8, top]], "#888", 9);
  line(points.slice(0, 2), "#2a788e", 4);
  line(points.slice(2), "#2a788e", 4);
  const [[ax, ay], [bx, by]] = points.slice(1, 3), zigzag = [[ax, ay]];
  for (let i = 1; i < 12; ++i) {
    const off = (i % 2 ? 1 : -1) * 0.004, length = Math.hypot(bx - ax, by - ay) || 1;
    zigzag.push([ax + ((bx - ax) * i) / 12 - (off * (by - ay)) / length, ay + ((by - ay) * i) / 12 + (off * (bx - ax)) / length]);
  }
  line([...zigzag, [bx, by]], "#c60", 1.5);
  [0, 3].forEach((i, joint) => {
    c.fillStyle = sliding[joint] ? "#fff" : "#063";
    c.strokeStyle = sliding[joint] ? "#c00" : "#063";
    c.lineWidth = 3;
    c.beginPath();
    c.arc(x(points[i][0]), y(points[i][1]), 6, 0, 7);
    c.fill();
    c.stroke();
  });
  c.fillStyle = "#222";
  c.textAlign = "center";
  c.fillText("joint full: sticks, open: slides", width / 2, height - 6);
  c.fillText("head", x(-beside * 0.3), y(head) + 22);
  c.fillText("frame", x(d + beside * 0.3), y(top) - 12);
  c.textAlign = "right";
  if (magnified > 1) c.fillText(`motion × ${magnified}`, width - 6, 14);
}

/** Contact wire, messenger and droppers about a pantograph; heights drawn with their own scales, told on the picture. */
export function drawLine(canvas, { places, wire, messenger, droppers }, position, supports) {
  const { c, width, height } = prepared(canvas);
  const first = places[0], last = places.at(-1);
  const x = (m) => 10 + ((width - 20) * (m - first)) / (last - first || 1);
  const highest = Math.max(...messenger), up = 0.42 * height;
  // The wire's motion is centimetres, the messenger's height a metre: two scales, one above the other.
  const wireAt = (m) => 0.72 * height - (0.22 * height * m) / 0.1;
  const messengerAt = (m) => up - (0.34 * height * m) / (highest || 1) ;
  const at = (values, place) => {
    const i = Math.min(places.length - 2, Math.max(0, Math.floor((place - first) / (places[1] - first))));
    const share = (place - places[i]) / (places[i + 1] - places[i]);
    return values[i] + share * (values[i + 1] - values[i]);
  };
  const polyline = (values, to, color, thick) => {
    c.strokeStyle = color;
    c.lineWidth = thick;
    c.beginPath();
    places.forEach((place, i) => (i ? c.lineTo(x(place), to(values[i])) : c.moveTo(x(place), to(values[i]))));
    c.stroke();
  };
  for (const [place, force] of droppers) {
    if (place < first || place > last) continue;
    c.setLineDash(force > 0 ? [] : [3, 3]);
    c.strokeStyle = force > 0 ? "#888" : "#c00";
    c.lineWidth = force > 0 ? 1 : 2;
    c.beginPath();
    c.moveTo(x(place), messengerAt(at(messenger, place)));
    c.lineTo(x(place), wireAt(at(wire, place)));
    c.stroke();
  }
  c.setLineDash([]);
  polyline(messenger, messengerAt, "#555", 1.5);
  polyline(wire, wireAt, "#111", 2.5);
  c.textAlign = "center";
  c.fillStyle = "#222";
  for (const place of supports)
    if (place >= first && place <= last) {
      c.fillRect(x(place) - 4, messengerAt(at(messenger, place)) - 6, 8, 6);
      c.fillText(`${place} m`, x(place), height - 4);
    }
  const head = wireAt(at(wire, position));
  c.strokeStyle = "#2a788e";
  c.lineWidth = 3;
  c.beginPath();
  c.moveTo(x(position) - 9, head + 3);
  c.lineTo(x(position) + 9, head + 3);
  c.moveTo(x(position), head + 3);
  c.lineTo(x(position) + 14, 0.86 * height);
  c.lineTo(x(position), 0.95 * height);
  c.stroke();
  c.strokeStyle = "#222";
  c.lineWidth = 1;
  c.beginPath();
  c.moveTo(14, wireAt(0));
  c.lineTo(14, wireAt(0.05));
  c.stroke();
  c.textAlign = "left";
  c.fillText("50 mm (wire)", 19, wireAt(0.025) + 4);
}
