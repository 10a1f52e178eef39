// Parallel coordinates: one line a case, a brush on every axis; the heads of the axes move and flip them.
import { canvas, el, replace } from "./dom.js";
import { theme } from "./colours.js";
import { byLevels, placesOf, scaleOf } from "./scales.js";
import { heading, isLife, letter } from "./words.js";

const LEAST = 268; // height of the axes
const MOST = 720;
const BOTTOM = 42; // room of the lines without a value
const EDGE = 12; // from the left end of a slot to its axis
const SLOT = 70; // least room of an axis and its labels
const LONG = 9; // letters of a label that makes its axis wider
const AT_ONCE = 400; // lines that are drawn before the page answers
const MOST_LINES = 12000; // more lines only blacken the picture
const MOST_TICKS = 14; // labels of numbers
const GRIP = 22; // how far from an axis a pointer takes it
const EMPTY = -0.1; // place of a missing value
const STILL = 5; // pixels within which a press is a click
const TURN = 30; // pixels downwards that flip an axis
const DASHES = [[], [8, 4], [2, 3], [9, 3, 2, 3]];
const HELP = "drag sideways or use the arrow keys to move the axis; click or drag down to flip it";

export function parallel(model, colours, say) {
  const lines = canvas(LEAST, "Parallel coordinates of the selected cases");
  const marks = canvas(LEAST, "");
  marks.node.removeAttribute("role");
  marks.node.setAttribute("aria-hidden", "true");
  const layer = el("div", { class: "axes" });
  const stack = el("div", { class: "stack" }, lines.node, marks.node, layer);
  const node = el("div", { class: "wide lines", tabindex: "0", role: "region", "aria-label": "Parallel coordinates" }, stack);
  const made = new Map(); // head and labels of each column
  let axes = [];
  let ends = []; // left and right end of the slot of each axis
  let [top, height] = [0, LEAST];
  let [run, drawn] = [0, 0];

  const x = (i) => ends[i][0] + EDGE;
  const turned = (column, place) => (model.views.flipped.includes(column.name) ? 1 - place : place);
  const y = (column, place) => top + (1 - (Number.isNaN(place) ? EMPTY : turned(column, place))) * height;
  const place = (column, at) => turned(column, 1 - (at - top) / height);

  // Head and labels of an axis. They are elements, so that they wrap, can be read aloud and take keys.
  function axisOf(column) {
    const button = el("button", { type: "button", "data-head": column.name });
    const scale = scaleOf(column);
    const step = column.codes && !column.number ? 1 : Math.ceil(scale.ticks.length / MOST_TICKS);
    const told = scale.ticks.filter((_, k) => k % step === 0);
    const places = placesOf(column);
    if (places.some((at) => at > 1.001)) told.push([1.06, isLife(column) ? "no failure" : "∞"]);
    if (places.some(Number.isNaN)) told.push([NaN, "no value"]);
    const ticks = told.map(([at, words]) => ({ at, node: el("span", { class: "tick" }, words) }));
    const part = { button, ticks, node: el("div", { class: "axis" }, button, ticks.map((t) => t.node)) };
    movable(column, part);
    return part;
  }

  function fit() {
    axes = model.views.axes.map((name) => model.table.columns.get(name)).filter(Boolean);
    for (const column of axes) if (!made.has(column.name)) made.set(column.name, axisOf(column));
    const parts = axes.map((column) => made.get(column.name));
    const weights = parts.map(({ ticks }) => (ticks.some((t) => t.node.textContent.length > LONG) ? 1.6 : 1));
    const total = weights.reduce((sum, w) => sum + w, 0);
    const width = Math.max(node.clientWidth || 600, total * SLOT);
    let left = 0;
    ends = weights.map((weight) => [left, (left += (weight * width) / total)]);
    const focused = document.activeElement;
    replace(layer, parts.map((part) => part.node));
    stack.style.width = `${width}px`;
    parts.forEach(({ node: part, button }, i) => {
      part.style.left = `${ends[i][0]}px`;
      part.style.width = `${ends[i][1] - ends[i][0]}px`;
      const flipped = model.views.flipped.includes(axes[i].name);
      button.textContent = `${heading(axes[i])} ${flipped ? "↓" : "↑"}`;
      button.setAttribute("aria-label", `${heading(axes[i])}, axis ${i + 1} of ${axes.length}, ${flipped ? "falls" : "rises"} upwards; ${HELP}`);
    });
    top = Math.max(0, ...parts.map(({ button }) => button.offsetHeight)) + 10;
    height = Math.min(MOST, Math.max(LEAST, ...parts.map(({ ticks }, i) => (axes[i].number ? 0 : ticks.length * Math.max(...ticks.map((t) => t.node.offsetHeight + 2))))));
    lines.fit(width, top + height + BOTTOM);
    marks.fit(width, top + height + BOTTOM);
    parts.forEach(({ ticks }, i) => labels(axes[i], ticks));
    if (layer.contains(focused)) focused.focus();
  }

  // Put the labels beside their places; one that would cover another is left out, the ends never.
  function labels(column, ticks) {
    const kept = [];
    for (const tick of [...ticks.slice(-1), ...ticks.slice(0, -1)]) {
      const half = tick.node.offsetHeight / 2;
      const at = y(column, tick.at);
      const free = kept.every(([other, room]) => Math.abs(other - at) >= half + room);
      tick.node.classList.toggle("hidden", !free);
      tick.node.style.top = `${at - half}px`;
      if (free) kept.push([at, half]);
    }
  }

  // Sideways a head takes its axis to another place, downwards it flips it, as do a click and the keys.
  function movable(column, { button, node: part }) {
    let from = null;
    let dragged = false;
    const flip = () => {
      const { flipped } = model.views;
      model.view("flipped", flipped.includes(column.name) ? flipped.filter((name) => name !== column.name) : [...flipped, column.name]);
    };
    const put = (to) => {
      const others = model.views.axes.filter((name) => name !== column.name);
      const at = Math.max(0, Math.min(others.length, to));
      model.view("axes", [...others.slice(0, at), column.name, ...others.slice(at)]);
    };
    const away = (event) => [event.clientX - from[0], event.clientY - from[1]];
    button.addEventListener("pointerdown", (event) => {
      from = [event.clientX, event.clientY];
      dragged = false;
      button.setPointerCapture(event.pointerId);
    });
    button.addEventListener("pointermove", (event) => {
      if (!from) return;
      const [across, down] = away(event);
      dragged ||= Math.hypot(across, down) > STILL;
      if (dragged) part.style.transform = Math.abs(across) > Math.abs(down) ? `translateX(${across}px)` : `translateY(${Math.max(0, Math.min(TURN, down))}px)`;
    });
    const end = (event) => {
      if (!from) return;
      const [across, down] = away(event);
      from = null;
      part.style.transform = "";
      if (!dragged || event.type !== "pointerup") return;
      const i = axes.indexOf(column);
      const at = local(event)[0];
      if (Math.abs(across) > Math.abs(down)) put(axes.filter((_, k) => k !== i && (ends[k][0] + ends[k][1]) / 2 < at).length);
      else if (down > TURN) flip();
    };
    button.addEventListener("pointerup", end);
    button.addEventListener("pointercancel", end);
    button.addEventListener("focus", () => part.scrollIntoView({ block: "nearest", inline: "nearest" }));
    button.addEventListener("click", (event) => {
      if (!dragged || !event.detail) flip(); // a key has no pointer that could have dragged
      dragged = false;
    });
    button.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (!step) return;
      event.preventDefault();
      put(axes.indexOf(column) + step);
    });
  }

  function path(context, row) {
    axes.forEach((column, i) => context[i ? "lineTo" : "moveTo"](x(i), y(column, placesOf(column)[row])));
  }

  // Draw the next lines, one colour after the other; return the place after them and their number.
  function batch(from, most) {
    const { context } = lines;
    const { list, index } = colours();
    const groups = new Map();
    let [at, taken] = [from, 0];
    for (; at < model.shuffled.length && taken < most; at++) {
      const row = model.shuffled[at];
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
      if (mine !== run || at >= model.shuffled.length || drawn >= Math.min(MOST_LINES, model.count)) return told();
      const until = performance.now() + 12;
      while (performance.now() < until && at < model.shuffled.length && drawn < MOST_LINES) {
        [at, taken] = batch(at, 100);
        drawn += taken;
      }
      requestAnimationFrame(more);
    };
    requestAnimationFrame(more);
    overlay();
  }

  function told() {
    const wide = node.scrollWidth > node.clientWidth + 1 ? "Scroll sideways for more axes. " : "";
    say(wide + (model.count > MOST_LINES ? `Lines of ${MOST_LINES.toLocaleString("en-US")} selected cases are drawn.` : ""));
  }

  function overlay() {
    const { context, size } = marks;
    const { ink, soft, paper, mark } = theme();
    context.clearRect(0, 0, size.width, size.height);
    axes.forEach((column, i) => axis(context, column, x(i), soft, mark));
    const thick = (row, width, colour) => {
      context.lineWidth = width;
      context.strokeStyle = colour;
      context.beginPath();
      path(context, row);
      context.stroke();
    };
    if (model.marked) for (const row of model.marked.slice(0, 400)) thick(row, 1, ink);
    context.font = "bold 12px system-ui, sans-serif";
    context.textAlign = "center";
    model.pins.forEach((row, i) => {
      context.setLineDash(DASHES[i % DASHES.length]);
      thick(row, 3, mark);
      context.setLineDash([]);
      if (axes.length < 2) return;
      const k = i % (axes.length - 1); // each letter between two other axes
      const [a, b] = [k, k + 1].map((j) => y(axes[j], placesOf(axes[j])[row]));
      const at = [x(k) * 0.3 + x(k + 1) * 0.7, a * 0.3 + b * 0.7 + 4];
      context.lineWidth = 4;
      context.strokeStyle = paper;
      context.strokeText(letter(i), ...at);
      context.fillStyle = ink;
      context.fillText(letter(i), ...at);
    });
    if (model.hovered >= 0) thick(model.hovered, 2.5, ink);
  }

  function axis(context, column, at, soft, mark) {
    context.lineWidth = 1;
    context.strokeStyle = soft;
    context.beginPath();
    context.moveTo(at, y(column, 1));
    context.lineTo(at, y(column, 0));
    context.stroke();
    const brush = model.brushes.get(column.name);
    if (!brush) return;
    [context.fillStyle, context.strokeStyle, context.lineWidth] = [mark, mark, 1.5];
    for (const [low, high] of pieces(column, scaleOf(column), brush)) {
      const [a, b] = [y(column, low), y(column, high)].sort((p, q) => p - q);
      context.globalAlpha = 0.35;
      context.fillRect(at - 8, a, 16, Math.max(2, b - a));
      context.globalAlpha = 1;
      context.strokeRect(at - 8, a, 16, Math.max(2, b - a));
    }
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
  let drag = null;

  marks.node.addEventListener("pointerdown", (event) => {
    const [left, at] = local(event);
    const column = axes.find((_, i) => Math.abs(x(i) - left) < GRIP);
    if (!column) return;
    const scale = scaleOf(column);
    const brush = model.brushes.get(column.name);
    const held = brush && !scale.levels ? pieces(column, scale, brush)[0] : null;
    const from = place(column, at);
    drag = { column, scale, from, held: held && from > held[0] && from < held[1] ? held : null, moved: false };
    marks.node.setPointerCapture(event.pointerId);
  });
  marks.node.addEventListener("pointermove", (event) => {
    const [left, at] = local(event);
    if (!drag) return model.hover(nearest(left, at));
    const to = place(drag.column, at);
    if (Math.abs(to - drag.from) > 0.01) drag.moved = true;
    if (!drag.moved) return;
    const [low, high] = drag.held ? drag.held.map((v) => v + to - drag.from) : [Math.min(to, drag.from), Math.max(to, drag.from)];
    model.brush(drag.column.name, drag.scale.piece(Math.max(0, low), Math.min(1, high)));
  });
  marks.node.addEventListener("pointerup", (event) => {
    if (drag && !drag.moved) clicked(place(drag.column, local(event)[1]));
    else if (!drag && model.hovered >= 0) model.pin(model.hovered);
    drag = null;
  });
  marks.node.addEventListener("pointercancel", () => (drag = null));
  marks.node.addEventListener("pointerleave", () => model.hover(-1));

  // A click on a level takes it into the brush or out of it; a click on an axis of numbers removes the brush.
  function clicked(at) {
    const { column, scale } = drag;
    if (!scale.levels) return model.brush(column.name, null);
    const away = (code) => Math.abs(scale.unit(code) - at);
    const code = column.levels.map((_, i) => i).filter((i) => away(i) >= 0).reduce((best, i) => (away(i) < away(best) ? i : best));
    const before = model.brushes.get(column.name) ?? [];
    const after = before.includes(code) ? before.filter((c) => c !== code) : [...before, code].sort((a, b) => a - b);
    model.brush(column.name, after.length && after.length < column.levels.length ? after : null);
  }

  function nearest(left, at) {
    if (axes.length < 2) return -1;
    let i = axes.findIndex((_, k) => x(k) > left) - 1;
    if (i < 0) i = i === -2 ? axes.length - 2 : 0;
    const share = (left - x(i)) / (x(i + 1) - x(i));
    const [a, b] = [placesOf(axes[i]), placesOf(axes[i + 1])];
    let [best, row] = [8, -1];
    for (let k = 0, seen = 0; k < model.shuffled.length && seen < drawn; k++) {
      const r = model.shuffled[k];
      if (model.misses[r]) continue;
      seen += 1;
      const away = Math.abs(y(axes[i], a[r]) * (1 - share) + y(axes[i + 1], b[r]) * share - at);
      if (away < best) [best, row] = [away, r];
    }
    return row;
  }

  return { node, fit, draw, overlay };
}
