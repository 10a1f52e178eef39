// A carriage from the side and from above: rollers and masses that pointer and arrow keys move, and forces as arrows.
import { el, replace } from "../dom.js";
import { number } from "../words.js";

const VIEWS = [
  ["from the side", 2, "z"],
  ["from above", 1, "y"],
]; // the axis that points up in the view; x, forward, points to the right
const EDGE = { left: 26, right: 120, top: 34, bottom: 28 }; // px around the carriage: for names, forces and arrows
const TALL = 250; // px of a view at most
const LONGEST = 0.3; // of the size of the carriage: the arrow of the largest force, as on the page of a carriage
const APART = 0.45; // of the smallest distance between rollers, so that the arrows of a pair do not meet
const STEP = 1; // mm of an arrow key
const FAR = 10; // mm with Shift
const KEYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

function shape(tag, attributes = {}, ...children) {
  const node = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) node.addEventListener(key.slice(2), value);
    else if (value !== null) node.setAttribute(key, value);
  }
  node.append(...children.flat().filter((child) => child !== null));
  return node;
}
const size = (vector) => Math.hypot(...vector);
const times = (vector, k) => vector.map((v) => v * k);

// An arrow in px: its shaft and its head.
function arrow([x, y], [dx, dy], kind) {
  const length = Math.hypot(dx, dy);
  if (length < 2) return null;
  const [u, v] = [dx / length, dy / length];
  const head = Math.min(8, length);
  const [ex, ey] = [x + dx, y + dy];
  const [bx, by] = [ex - u * head, ey - v * head];
  return shape("g", { class: kind }, shape("path", { d: `M${x} ${y}L${bx} ${by}`, class: "shaft" }), shape("path", { d: `M${ex} ${ey}L${bx - v * head * 0.45} ${by + u * head * 0.45}L${bx + v * head * 0.45} ${by - u * head * 0.45}Z`, class: "head" }));
}

// `moved(kind, index, at)` is told where a handle is now, while it moves and when it rests.
export function carriagePicture({ moved }) {
  const node = el("div", { class: "views" });
  let places = null;
  let loads = null;
  let shown = 0; // the load case
  let frame = null; // scale and ends of the views, which stay while a handle moves
  let held = null; // the handle that the pointer moves

  function fit() {
    const tips = forces().flatMap((list) => list.map((force, j) => places.rollers[j].at.map((v, axis) => v + force[axis])));
    const points = [...[...places.rollers, ...places.masses].map((one) => one.at), ...tips];
    const ends = [0, 1, 2].map((axis) => [Math.min(...points.map((at) => at[axis])), Math.max(...points.map((at) => at[axis]))]);
    const width = Math.max(280, node.clientWidth || 600);
    const span = Math.max(...ends.map(([low, high]) => high - low), 1);
    const across = (width - EDGE.left - EDGE.right) / Math.max(ends[0][1] - ends[0][0], 0.2 * span);
    const up = (TALL - EDGE.top - EDGE.bottom) / Math.max(...[1, 2].map((axis) => ends[axis][1] - ends[axis][0]), 0.05 * span);
    frame = { ends, width, scale: Math.min(across, up) };
  }

  // Arrows in mm, of the forces of the rollers on their rails.
  function forces() {
    if (!loads) return [];
    const { rollers } = places;
    const radial = rollers.map((one, j) => times(one.pushes, -loads.radial[shown][j]));
    const axial = rollers.map((one, j) => times(one.axis, loads.axial[shown][j]));
    const gaps = rollers.flatMap((a) => rollers.map((b) => size(a.at.map((v, i) => v - b.at[i])))).filter((gap) => gap > 0);
    const whole = Math.max(...[0, 1, 2].map((axis) => Math.max(...rollers.map((r) => r.at[axis])) - Math.min(...rollers.map((r) => r.at[axis]))), 1);
    const most = [Math.min(LONGEST * whole, APART * Math.min(...gaps, Infinity)), LONGEST * whole];
    return [radial, axial].map((list, i) => list.map((force) => times(force, most[i] / Math.max(...list.map(size), 1e-9))));
  }

  function view([words, up, letter]) {
    const { ends, scale, width } = frame;
    const height = Math.round(EDGE.top + EDGE.bottom + scale * (ends[up][1] - ends[up][0]));
    const place = (at) => [EDGE.left + scale * (at[0] - ends[0][0]), height - EDGE.bottom - scale * (at[up] - ends[up][0])];
    const [radial, axial] = forces();
    const arrows = [[radial, "radial"], [axial, "axial"]].flatMap(([list, kind]) => (list ?? []).map((force, j) => arrow(place(places.rollers[j].at), [scale * force[0], -scale * force[up]], kind)));
    const labels = new Map(); // rollers at one point of the view share a label
    places.rollers.forEach((one, j) => {
      const text = !loads ? one.name : loads.radial[shown][j] === 0 ? `${one.name} lifted` : `${one.name} ${number(loads.radial[shown][j])}, ${number(loads.axial[shown][j])}`;
      const key = place(one.at).map(Math.round).join();
      labels.set(key, [...(labels.get(key) ?? []), text]);
    });
    const texts = [...labels].map(([key, lines]) => {
      const [x, y] = key.split(",").map(Number);
      return shape("text", { x: x + 9, y: y - 8 - 11 * (lines.length - 1), class: "label" }, lines.map((line, i) => shape("tspan", { x: x + 9, dy: i ? 11 : 0 }, line)));
    });
    const handle = (kind, index, name, at, drawing) => {
      const key = `${kind} ${index} ${letter}`;
      const [x, y] = place(at);
      return shape("g", { class: `handle ${kind}`, transform: `translate(${x} ${y})`, tabindex: 0, role: "button", "aria-roledescription": "point that moves", "aria-describedby": "carriage-hint", "aria-label": `${name}, ${words}: x ${number(at[0])}, ${letter} ${number(at[up])} mm`, "data-handle": key, onkeydown: (event) => step(event, kind, index, at, up), onpointerdown: (event) => grip(event, svg, kind, index, at, up) }, shape("circle", { r: 13, class: "grip" }), drawing);
    };
    const handles = [
      ...places.rollers.map((one, j) => handle("roller", j, `Roller ${one.name}`, one.at, shape("circle", { r: 6, class: "mark" }))),
      ...places.masses.map((one, i) => handle("mass", i, i ? `Payload ${i}` : "Carriage", one.at, shape("path", { d: "M0 -6L6 0L0 6L-6 0Z", class: "mark" }))),
    ];
    const axes = shape("g", { class: "axes" }, shape("text", { x: width - 4, y: height - 6, "text-anchor": "end" }, `${words}; right: x, forward; up: ${up === 2 ? "z" : "y, left"}`));
    const svg = shape("svg", { viewBox: `0 0 ${width} ${height}`, width, height, role: "group", "aria-label": `The carriage ${words}`, onpointermove: drag, onpointerup: release, onpointercancel: release }, axes, arrows, handles, texts);
    return svg;
  }

  function step(event, kind, index, at, up) {
    const way = KEYS[event.key];
    if (!way) return;
    event.preventDefault();
    const by = event.shiftKey ? FAR : STEP;
    put(kind, index, at, up, at[0] + by * way[0], at[up] + by * way[1]);
    moved(kind, index, at);
  }

  function put(kind, index, at, up, x, height) {
    const round = (value) => Number(value.toFixed(3));
    at[0] = round(x);
    at[up] = round(height);
    draw();
  }

  function grip(event, svg, kind, index, at, up) {
    if (event.button) return;
    event.preventDefault();
    svg.setPointerCapture(event.pointerId);
    const ratio = frame.width / svg.getBoundingClientRect().width;
    held = { kind, index, up, from: [...at], start: [event.clientX, event.clientY], mm: ratio / frame.scale, at: null, svg };
    document.querySelector(`[data-handle="${event.currentTarget.dataset.handle}"]`).focus({ preventScroll: true });
  }

  function drag(event) {
    if (!held) return;
    const [dx, dy] = [event.clientX - held.start[0], event.clientY - held.start[1]].map((px) => Math.round(px * held.mm));
    const at = (held.kind === "roller" ? places.rollers : places.masses)[held.index].at;
    put(held.kind, held.index, at, held.up, held.from[0] + dx, held.from[held.up] - dy);
    held.at = [...at];
    moved(held.kind, held.index, at);
  }

  function release() {
    if (!held) return;
    held = null;
    fit();
    draw();
  }

  // The two drawings stay, so that the one with the pointer keeps it; what they hold is new.
  function draw() {
    if (!places || !places.rollers.length) return replace(node);
    if (!frame) fit();
    const focus = node.contains(document.activeElement) ? document.activeElement.dataset.handle : null;
    const fresh = VIEWS.map(view);
    if (held && node.children.length === fresh.length) {
      fresh.forEach((svg, i) => node.children[i].replaceChildren(...svg.childNodes));
    } else replace(node, fresh);
    if (focus) node.querySelector(`[data-handle="${focus}"]`)?.focus({ preventScroll: true });
  }

  return {
    node,
    show(found, forces_, load_case) {
      places = found;
      loads = forces_;
      shown = Math.max(0, Math.min(load_case, places.cases.length - 1));
      if (held) {
        const one = (held.kind === "roller" ? places.rollers : places.masses)[held.index];
        if (one && held.at) one.at = [...held.at];
      } else fit();
      draw();
    },
    redraw() {
      if (!places) return;
      fit();
      draw();
    },
    held: () => held !== null,
  };
}
