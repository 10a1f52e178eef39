// Scatter of two columns: a shape for each state, a colour by a chosen column; other cases stay in pale grey.
import { SHAPES, isDark, packed, theme } from "./colours.js";
import { canvas, el } from "./dom.js";
import { plot } from "./plot.js";
import { placesOf, scaleOf } from "./scales.js";
import { heading, letter } from "./words.js";

const NEAR = 12; // pixels within which a pointer finds a point
const HEIGHT = 320;
const SPREAD = 0.32; // share of the room of a level over which its points are spread

// Shapes as masks of (2 r + 1)² pixels.
function masks(r) {
  const tests = {
    disc: (u, v) => u * u + v * v <= r * r,
    ring: (u, v) => u * u + v * v <= r * r && u * u + v * v > (r - 1.6) * (r - 1.6),
    triangle: (u, v) => v >= -r && v <= r - 1 && Math.abs(u) <= (v + r) / 2 + 0.5,
    square: (u, v) => Math.max(Math.abs(u), Math.abs(v)) <= r - 1,
    cross: (u, v) => Math.abs(Math.abs(u) - Math.abs(v)) < 1.1,
    plus: (u, v) => Math.min(Math.abs(u), Math.abs(v)) < 1.1,
    diamond: (u, v) => Math.abs(u) + Math.abs(v) <= r,
  };
  return SHAPES.map((name) => {
    const cells = [];
    for (let v = -r; v <= r; v++) for (let u = -r; u <= r; u++) if (tests[name](u, v)) cells.push([u, v]);
    return cells;
  });
}

export function scatter(model, colours) {
  const base = plot(HEIGHT, "");
  const { context, size } = base;
  const top = canvas(HEIGHT, "Scatter of the selected cases; arrow keys step through them, Enter pins");
  const points = document.createElement("canvas");
  base.node.removeAttribute("role");
  base.node.removeAttribute("aria-label");
  base.node.setAttribute("aria-hidden", "true");
  top.node.setAttribute("tabindex", "0");
  top.node.setAttribute("role", "application");
  const node = el("div", { class: "stack" }, base.node, top.node);
  const { columns, count } = model.table;
  let [xs, ys] = [new Float32Array(count), new Float32Array(count)];
  // Points of a level are spread a little, always in the same way.
  const spread = (row, salt) => ((((row * 2654435761 + salt * 40503) >>> 0) % 1000) / 1000 - 0.5) * SPREAD;

  function places(column, to, salt) {
    const room = scaleOf(column).levels ? 1 / Math.max(1, column.levels.length) : 0;
    const places = placesOf(column);
    for (let i = 0; i < count; i++) to[i] = places[i] + (room ? spread(i, salt) * room : 0);
  }

  function axes() {
    return [columns.get(model.views.x), columns.get(model.views.y)];
  }

  function axesChanged() {
    const [cx, cy] = axes();
    places(cx, xs, 1);
    places(cy, ys, 2);
  }

  // An order of drawing in which colours and states alternate and the rare ones come last: none is hidden by another.
  const orders = new WeakMap();
  function alternating(index) {
    if (!orders.has(index)) {
      const [seen, turn] = [new Uint32Array(2048), new Uint32Array(count)];
      for (const row of model.shuffled) turn[row] = seen[index[row] * 8 + model.state[row]]++;
      orders.set(index, model.shuffled.slice().sort((a, b) => turn[b] - turn[a]));
    }
    return orders.get(index);
  }

  function draw() {
    const [cx, cy] = axes();
    base.clear();
    base.frame(scaleOf(cx), scaleOf(cy), heading(cx), heading(cy));
    if (!size.width) return;
    const { list, index } = colours();
    const [wide, tall] = [base.node.width, base.node.height];
    const picture = new ImageData(wide, tall);
    const pixels = new Uint32Array(picture.data.buffer);
    const radius = Math.max(1, Math.round((model.count > 20000 ? 1.5 : model.count > 2000 ? 2.5 : 4) * size.ratio));
    const shapes = masks(radius);
    const grey = count > 20000 ? [[0, 0]] : masks(1)[0];
    const colour = list.map(packed);
    const pale = packed(isDark() ? "#3a4148" : "#d9dde1");
    const put = (row, cells, value) => {
      const [left, top] = [Math.round(base.x(xs[row]) * size.ratio), Math.round(base.y(ys[row]) * size.ratio)];
      for (const [u, v] of cells) {
        const [a, b] = [left + u, top + v];
        if (a >= 0 && b >= 0 && a < wide && b < tall) pixels[b * wide + a] = value;
      }
    };
    for (let i = 0; i < count; i++) if (model.misses[i]) put(i, grey, pale);
    for (const row of alternating(index)) if (!model.misses[row]) put(row, shapes[model.state[row]], colour[index[row]]);
    [points.width, points.height] = [wide, tall];
    points.getContext("2d").putImageData(picture, 0, 0);
    context.drawImage(points, 0, 0, size.width, HEIGHT);
    marks();
  }

  function marks() {
    const { context } = top;
    context.clearRect(0, 0, top.size.width, HEIGHT);
    const { ink, mark, paper } = theme();
    const circle = (row, r, colour, width) => {
      for (const [c, w] of [[paper, width + 2], [colour, width]]) {
        context.beginPath();
        context.arc(base.x(xs[row]), base.y(ys[row]), r, 0, 7);
        context.lineWidth = w;
        context.strokeStyle = c;
        context.stroke();
      }
    };
    for (const row of model.marked ?? []) circle(row, 5, ink, 1.2);
    model.pins.forEach((row, i) => {
      circle(row, 9, mark, 2.5);
      context.fillStyle = ink;
      context.font = "bold 12px system-ui, sans-serif";
      context.textAlign = "left";
      context.fillText(letter(i), base.x(xs[row]) + 11, base.y(ys[row]) - 8);
    });
    if (model.hovered >= 0) circle(model.hovered, 7, ink, 2);
  }

  function nearest(left, top) {
    let [best, row] = [NEAR * NEAR, -1];
    for (let i = 0; i < count; i++) {
      if (model.misses[i]) continue;
      const [u, v] = [base.x(xs[i]) - left, base.y(ys[i]) - top];
      if (u * u + v * v < best) [best, row] = [u * u + v * v, i];
    }
    return row;
  }

  const at = (event) => {
    const box = top.node.getBoundingClientRect();
    return nearest(event.clientX - box.left, event.clientY - box.top);
  };
  top.node.addEventListener("pointermove", (event) => model.hover(at(event)));
  top.node.addEventListener("pointerleave", () => model.hover(-1));
  top.node.addEventListener("click", (event) => {
    const row = at(event);
    if (row >= 0) model.pin(row);
  });
  // the next case to the right or left, in the order of the horizontal axis
  top.node.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
    if (step) {
      const rows = model.rows().sort((a, b) => (xs[a] || 0) - (xs[b] || 0) || a - b);
      if (rows.length) model.hover(rows[(rows.indexOf(model.hovered) + step + rows.length) % rows.length]);
    } else if ((event.key === "Enter" || event.key === " ") && model.hovered >= 0) model.pin(model.hovered);
    else return;
    event.preventDefault();
  });

  const fit = (width) => {
    base.fit(width);
    top.fit(width);
  };
  return { node, fit, draw, marks, axesChanged, place: (row) => [base.x(xs[row]), base.y(ys[row])] };
}
