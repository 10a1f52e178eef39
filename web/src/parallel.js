// Parallel coordinates: one line a case, a brush on every axis.
import { canvas, el } from "./dom.js";
import { theme } from "./colours.js";
import { byLevels, placesOf, scaleOf } from "./scales.js";
import { heading } from "./words.js";

const TOP = 58; // room of the heads
const HEIGHT = 360;
const BOTTOM = 34; // room of the lines without a value
const SPACING = 92; // least distance of two axes
const AT_ONCE = 400; // lines that are drawn before the page answers
const MOST_LINES = 12000; // more lines only blacken the picture
const GRIP = 22; // how far from an axis a pointer takes it
const EMPTY = -0.1; // place of a missing value

export function parallel(model, colours, say) {
  const lines = canvas(HEIGHT, "Parallel coordinates of the selected cases");
  const marks = canvas(HEIGHT, "");
  marks.node.removeAttribute("role");
  marks.node.setAttribute("aria-hidden", "true");
  const stack = el("div", { class: "stack" }, lines.node, marks.node);
  const node = el("div", { class: "wide", tabindex: "0", role: "region", "aria-label": "Parallel coordinates" }, stack);
  const shuffled = shuffle(model.table.count);
  let axes = [];
  let run = 0;
  let drawn = 0;

  const x = (i) => (axes.length === 1 ? lines.size.width / 2 : 46 + (i * (lines.size.width - 92)) / (axes.length - 1));
  const y = (place) => TOP + (1 - (Number.isNaN(place) ? EMPTY : place)) * (HEIGHT - TOP - BOTTOM);
  const place = (at) => 1 - (at - TOP) / (HEIGHT - TOP - BOTTOM);

  function fit() {
    axes = model.views.axes.map((name) => model.table.columns.get(name)).filter(Boolean);
    const width = Math.max(node.clientWidth || 600, axes.length * SPACING);
    lines.fit(width);
    marks.fit(width);
    stack.style.width = `${width}px`;
  }

  function path(context, row) {
    axes.forEach((column, i) => context[i ? "lineTo" : "moveTo"](x(i), y(placesOf(column)[row])));
  }

  // Draw the next lines, one colour after the other; return the place after them and their number.
  function batch(from, most) {
    const { context } = lines;
    const { list, index } = colours();
    const groups = new Map();
    let [at, taken] = [from, 0];
    for (; at < shuffled.length && taken < most; at++) {
      const row = shuffled[at];
      if (model.misses[row]) continue;
      const key = index[row] * 8 + model.state[row];
      if (!groups.has(key)) groups.set(key, []);
      groups.get(key).push(row);
      taken += 1;
    }
    for (const [key, rows] of groups) {
      const state = key % 8;
      context.strokeStyle = list[Math.floor(key / 8)];
      context.setLineDash(state === 0 ? [] : state === 1 || state === 6 ? [6, 2] : [2, 3]);
      for (const row of rows) {
        context.beginPath();
        path(context, row);
        context.stroke();
      }
    }
    return [at, taken];
  }

  function draw() {
    const mine = ++run;
    const { context, size } = lines;
    context.clearRect(0, 0, size.width, size.height);
    context.lineWidth = 1;
    context.globalAlpha = Math.max(0.08, Math.min(0.8, 12 / Math.sqrt(Math.max(1, model.count))));
    let [at, taken] = batch(0, AT_ONCE);
    drawn = taken;
    const more = () => {
      if (mine !== run || at >= shuffled.length || drawn >= Math.min(MOST_LINES, model.count)) return told();
      const until = performance.now() + 12;
      while (performance.now() < until && at < shuffled.length && drawn < MOST_LINES) {
        [at, taken] = batch(at, 100);
        drawn += taken;
      }
      requestAnimationFrame(more);
    };
    requestAnimationFrame(more);
    overlay();
  }

  function told() {
    say(model.count > MOST_LINES ? `Lines of ${MOST_LINES.toLocaleString("en-US")} selected cases are drawn.` : "");
  }

  function overlay() {
    const { context, size } = marks;
    const { ink, soft, paper, mark } = theme();
    context.clearRect(0, 0, size.width, size.height);
    context.font = "11px system-ui, sans-serif";
    axes.forEach((column, i) => axis(context, column, x(i), { ink, soft, paper, mark }));
    const thick = (row, width, colour) => {
      context.lineWidth = width;
      context.strokeStyle = colour;
      context.beginPath();
      path(context, row);
      context.stroke();
    };
    if (model.marked) for (const row of model.marked.slice(0, 400)) thick(row, 1, ink);
    model.pins.forEach((row, i) => {
      context.setLineDash(i ? [8, 4] : []);
      thick(row, 3, mark);
    });
    context.setLineDash([]);
    if (model.hovered >= 0) thick(model.hovered, 2.5, ink);
  }

  function axis(context, column, at, { ink, soft, paper, mark }) {
    const scale = scaleOf(column);
    context.lineWidth = 1;
    context.strokeStyle = soft;
    context.beginPath();
    context.moveTo(at, y(1));
    context.lineTo(at, y(0));
    context.stroke();
    const text = (words, left, top, colour) => {
      context.lineWidth = 3;
      context.strokeStyle = paper;
      context.strokeText(words, left, top);
      context.fillStyle = colour;
      context.fillText(words, left, top);
    };
    context.textAlign = "center";
    wrapped(heading(column), 15, 4).forEach((line, k) => text(line, at, 11 + 12 * k, ink));
    const last = axes.length > 1 && column === axes[axes.length - 1]; // its labels would be cut off on the right
    context.textAlign = last ? "right" : "left";
    const shown = scale.ticks.length > 14 ? scale.ticks.filter((_, k) => k % Math.ceil(scale.ticks.length / 14) === 0) : scale.ticks;
    for (const [where, words] of shown) text(words.length > 14 ? `${words.slice(0, 13)}…` : words, last ? at - 5 : at + 5, y(where) + 4, ink);
    const brush = model.brushes.get(column.name);
    if (!brush) return;
    context.fillStyle = mark;
    context.globalAlpha = 0.35;
    for (const [low, high] of pieces(column, scale, brush)) context.fillRect(at - 8, y(high), 16, Math.max(2, y(low) - y(high)));
    context.globalAlpha = 1;
    context.strokeStyle = mark;
    context.lineWidth = 1.5;
    for (const [low, high] of pieces(column, scale, brush)) context.strokeRect(at - 8, y(high), 16, Math.max(2, y(low) - y(high)));
  }

  // Ends of a brush on the axis, from 0 to 1.
  function pieces(column, scale, brush) {
    if (byLevels(column)) {
      const half = 0.3 / Math.max(1, column.levels.length);
      return brush.map((code) => [scale.unit(code) - half, scale.unit(code) + half]);
    }
    const end = (value, open) => (Number.isFinite(value) ? scale.unit(value) : open);
    const [low, high] = [end(brush[0], 0), end(brush[1], 1)];
    return [[Number.isNaN(low) ? 0 : Math.max(0, low), Number.isNaN(high) ? 1 : Math.min(1, high)]];
  }

  const local = (event) => {
    const box = marks.node.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  const taken = (left) => axes.findIndex((_, i) => Math.abs(x(i) - left) < GRIP);
  let drag = null;

  marks.node.addEventListener("pointerdown", (event) => {
    const [left, top] = local(event);
    const i = taken(left);
    if (i < 0) return;
    const scale = scaleOf(axes[i]);
    const brush = model.brushes.get(axes[i].name);
    const held = brush && !scale.levels ? pieces(axes[i], scale, brush)[0] : null;
    const at = place(top);
    drag = { column: axes[i], scale, from: at, held: held && at > held[0] && at < held[1] ? held : null, moved: false };
    marks.node.setPointerCapture(event.pointerId);
  });
  marks.node.addEventListener("pointermove", (event) => {
    const [left, top] = local(event);
    if (!drag) return model.hover(nearest(left, top));
    const at = place(top);
    if (Math.abs(at - drag.from) > 0.01) drag.moved = true;
    if (!drag.moved) return;
    const shift = at - drag.from;
    const [low, high] = drag.held ? drag.held.map((v) => v + shift) : [Math.min(at, drag.from), Math.max(at, drag.from)];
    model.brush(drag.column.name, drag.scale.piece(Math.max(0, low), Math.min(1, high)));
  });
  marks.node.addEventListener("pointerup", (event) => {
    if (drag && !drag.moved) clicked(place(local(event)[1]));
    else if (!drag && model.hovered >= 0) model.pin(model.hovered);
    drag = null;
  });
  marks.node.addEventListener("pointerleave", () => model.hover(-1));

  // A click on a level takes it into the brush or out of it; a click on an axis of numbers removes the brush.
  function clicked(at) {
    const { column, scale } = drag;
    if (!scale.levels) return model.brush(column.name, null);
    const n = column.levels.length;
    const code = Math.max(0, Math.min(n - 1, Math.floor(at * n)));
    const before = model.brushes.get(column.name) ?? [];
    const after = before.includes(code) ? before.filter((c) => c !== code) : [...before, code].sort((a, b) => a - b);
    model.brush(column.name, after.length && after.length < n ? after : null);
  }

  function nearest(left, top) {
    if (axes.length < 2) return -1;
    let i = axes.findIndex((_, k) => x(k) > left) - 1;
    if (i < 0) i = i === -2 ? axes.length - 2 : 0;
    const share = (left - x(i)) / (x(i + 1) - x(i));
    const [a, b] = [placesOf(axes[i]), placesOf(axes[i + 1])];
    let [best, row] = [8, -1];
    for (let k = 0, seen = 0; k < shuffled.length && seen < drawn; k++) {
      const r = shuffled[k];
      if (model.misses[r]) continue;
      seen += 1;
      const away = Math.abs(y(a[r]) * (1 - share) + y(b[r]) * share - top);
      if (away < best) [best, row] = [away, r];
    }
    return row;
  }

  return { node, fit, draw, overlay };
}

// A fixed order in which every part of the study comes early.
function shuffle(n) {
  const order = Uint32Array.from({ length: n }, (_, i) => i);
  let seed = 12345;
  for (let i = n - 1; i > 0; i--) {
    seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0;
    const j = seed % (i + 1);
    [order[i], order[j]] = [order[j], order[i]];
  }
  return order;
}

export function wrapped(text, width, most) {
  const rows = [""];
  for (const word of text.split(" ")) {
    const last = rows[rows.length - 1];
    if (last && last.length + word.length >= width) rows.push(word);
    else rows[rows.length - 1] = last ? `${last} ${word}` : word;
  }
  if (rows.length > most) rows.splice(most - 1, rows.length, `${rows.slice(most - 1).join(" ").slice(0, width - 1)}…`);
  return rows.map((row) => (row.length > width + 4 ? `${row.slice(0, width + 3)}…` : row));
}
