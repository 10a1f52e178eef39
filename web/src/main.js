// The explorer: linked views of the cases of a study, and `window.trackroller` for scripts.
import { written, read, isOurs } from "./address.js";
import { brushes } from "./brushes.js";
import { cards, repeatCommand, solveCommand } from "./cards.js";
import { SHAPES, colouring } from "./colours.js";
import { load } from "./data.js";
import { el, reducedMotion, replace, select } from "./dom.js";
import { goals } from "./goals.js";
import { histogram } from "./histogram.js";
import { lists } from "./lists.js";
import { Model, brushOf } from "./model.js";
import { parallel } from "./parallel.js";
import { paretoRows } from "./pareto.js";
import { scaleOf } from "./scales.js";
import { scatter } from "./scatter.js";
import { slices } from "./slices.js";
import { table } from "./table.js";
import { count, heading } from "./words.js";

const QUICK = 20000; // cases; above, the running medians follow when a brush rests
const FIRST_OUTPUTS = 4; // outputs that have an axis at the start
const KEPT = [0, 6]; // states that roll inside the model: valid, and without the constraints of the study

function counts(model) {
  const shown = (name) => el("data", { "data-count": name }, "0");
  const [selected, valid, left] = ["selected", "valid", "left-out"].map(shown);
  const why = el("span", { class: "facts" });
  const clear = el("button", { type: "button", onclick: () => model.clear() }, "Clear the selection");
  const hide = el("button", { type: "button", "data-hide": "", onclick: () => model.brush("state", hides() ? null : KEPT) }, "Hide what skids, lifts off or lies outside the model");
  const hides = () => String(model.brushes.get("state")) === String(KEPT);
  const told = el("span", { class: "told", role: "status", "aria-live": "polite" });
  told.append(el("span", {}, selected, ` of ${count(model.table.count)} cases selected`), el("span", {}, valid, " valid"), el("span", {}, left, " left out ", why));
  const node = el("div", { class: "counts" }, hide, clear, told); // the buttons keep their place whatever the counts are
  const set = (field, n) => {
    field.textContent = count(n);
    field.setAttribute("value", String(n));
  };
  return {
    node,
    draw() {
      set(selected, model.count);
      set(valid, model.byState[0]);
      set(left, model.count - model.byState[0]);
      const lost = model.table.states.map((name, i) => [name, model.byState[i]]).slice(1).filter(([, n]) => n);
      why.textContent = lost.length ? `(${lost.map(([name, n]) => `${count(n)} ${name}`).join(", ")})` : "";
      hide.setAttribute("aria-pressed", String(hides()));
      clear.disabled = !model.brushes.size && !model.chosen;
    },
  };
}

function legend(model, colours) {
  const node = el("div", { class: "legend" });
  function draw() {
    const column = model.table.columns.get(model.views.colour);
    const { legend: entries, ramp, list } = colours();
    const patch = (colour, shape) => {
      const sign = el("span", { class: shape ? `sign ${shape}` : "sign disc", "aria-hidden": "true" });
      sign.style.color = colour;
      return sign;
    };
    const own = entries
      ? entries.filter((_, i) => column.name !== "state" || model.byState[i]).map(([colour, text], i) => el("span", {}, patch(colour, column.name === "state" ? SHAPES[model.table.states.indexOf(text)] : "disc"), ` ${text}`))
      : [el("span", {}, `${heading(column)}: ${ramp[0]} `, list.slice(0, -1).filter((_, i) => i % 3 === 0).map((c) => patch(c, "square")), ` ${ramp[1]}`)];
    const shapes = column.name === "state" ? [] : model.table.states.map((text, i) => [text, i]).filter(([, i]) => model.byState[i]).map(([text, i]) => el("span", {}, patch("currentColor", SHAPES[i]), ` ${text}`));
    replace(node, own, shapes);
  }
  return { node, draw };
}

// Choices, conditions, the worst case of the design, outputs, state.
function firstAxes(study, factors, shown) {
  const { design } = study.lists;
  const names = (columns) => columns.map((c) => c.name);
  const chosen = (name) => design.factors.includes(name);
  const first = design ? [...names(factors).filter(chosen), ...names(factors).filter((name) => !chosen(name)), "design_worst"] : names(factors);
  return [...first, ...names(shown), "state"];
}

function start(study, place) {
  const model = new Model(study);
  const [factors, outputs] = [study.of("factor"), study.of("output")];
  const first = outputs.filter((c) => !Number.isNaN(scaleOf(c).low) && scaleOf(c).known !== false);
  const shown = (first.length ? first : outputs).slice(0, FIRST_OUTPUTS);
  const y = shown[0] ?? factors[1] ?? factors[0] ?? study.columns.get("state");
  const x = factors.find((c) => c.number) ?? factors[0] ?? study.columns.get("regime");
  Object.assign(model.views, { x: x.name, y: y.name, histogram: y.name, axes: firstAxes(study, factors, shown) });

  let cached = null;
  const colours = () => {
    const column = study.columns.get(model.views.colour);
    cached ??= colouring(column, scaleOf(column), study.count);
    return cached;
  };

  const note = el("p", { class: "facts" });
  const bar = counts(model);
  const lines = parallel(model, colours, (text) => (note.textContent = text));
  const points = scatter(model, colours);
  const bars = histogram(model);
  const barsSaid = el("p", { class: "facts" });
  const card = cards(model);
  const list = table(model);
  const cuts = slices(model);
  const aims = goals(model);
  const fields = brushes(model);
  const groups = lists(model);
  const key = legend(model, colours);
  const parts = { goals: aims, slices: cuts, table: list };

  const every = study.of("factor", "input", "design", "output", "state").filter((c) => c.name !== "reason" && !c.name.startsWith("validity"));
  const options = every.map((c) => [c.name, heading(c)]);
  const choose = (words, view) => select(words, options, model.views[view], (name) => model.view(view, name));
  const choices = { x: choose("Across", "x"), y: choose("Up", "y"), colour: choose("Colour", "colour"), histogram: choose("Histogram of", "histogram") };
  const axisBoxes = every.map((column) => {
    const box = el("input", { type: "checkbox", "data-axis": column.name });
    box.addEventListener("change", () => {
      const others = model.views.axes.filter((name) => name !== column.name);
      model.view("axes", box.checked ? [...others, column.name] : others);
    });
    return el("label", {}, box, ` ${column.label}`);
  });
  const link = el("button", { type: "button", onclick: () => remember(true) }, "View to the address");

  function section(title, ...content) {
    return el("section", {}, el("h3", {}, title), content);
  }
  replace(
    place,
    bar.node,
    el("p", { class: "facts" }, "Drag along an axis to select; click a level or an empty axis to take it back. Drag the head of an axis sideways to move it, down to flip it. Heads and fields work with the keyboard as well."),
    key.node,
    lines.node,
    note,
    groups.nodes,
    el("details", {}, el("summary", {}, "Brushes as numbers and names"), fields.node),
    el("details", {}, el("summary", {}, "Axes shown"), el("div", { class: "tools boxes" }, axisBoxes)),
    card.hovered,
    el("div", { class: "pair" }, el("div", {}, el("div", { class: "tools" }, choices.x.node, choices.y.node, choices.colour.node), points.node), el("div", {}, el("div", { class: "tools" }, choices.histogram.node), bars.node, barsSaid)),
    card.pinned,
    factors.length ? section(study.grid ? "Slices of the grid" : "Median over a factor", cuts.node) : null,
    outputs.length > 1 || (outputs.length && factors.some((c) => c.number)) ? section("Goals", aims.node) : null,
    section("Selected cases", list.node),
    el("div", { class: "tools" }, link),
  );

  let [later, medians] = [0, 0]; // timers
  const draws = {
    selection() {
      bar.draw();
      key.draw();
      lines.draw();
      points.draw();
      barsSaid.textContent = bars.draw();
      list.draw();
      fields.draw();
      groups.draw();
      aims.draw();
      if (study.grid) return;
      clearTimeout(medians);
      if (study.count > QUICK) medians = setTimeout(cuts.draw, 120);
      else cuts.draw();
    },
    view() {
      cached = null;
      for (const view of Object.keys(choices)) choices[view].field.value = model.views[view];
      for (const box of place.querySelectorAll("[data-axis]")) box.checked = model.views.axes.includes(box.dataset.axis);
      points.axesChanged();
      lines.fit();
      key.draw();
      lines.draw();
      points.draw();
      barsSaid.textContent = bars.draw();
    },
    pins() {
      card.draw();
      lines.overlay();
      points.marks();
      list.view();
    },
    hover() {
      card.hover();
      lines.overlay();
      points.marks();
    },
    marked() {
      lines.overlay();
      points.marks();
    },
    sort: () => list.draw(),
    slice: () => cuts.draw(),
  };
  model.listen((what) => {
    draws[what]();
    if (what === "hover") return;
    clearTimeout(later);
    later = setTimeout(remember, 400);
  });

  function remember(wanted) {
    if (wanted === true || isOurs(location.hash) || model.brushes.size || model.pins.length) history.replaceState(null, "", written(model, parts));
  }

  function fit() {
    for (const view of [points, bars]) view.fit(view.node.parentElement.clientWidth);
    lines.fit();
    cuts.fit();
  }
  function all() {
    fit();
    model.counted();
    draws.view();
    draws.pins();
    cuts.draw();
  }
  const opened = read(location.hash, model, parts);
  if (opened) {
    aims.restore();
    cuts.restore();
  }
  all();
  if (opened) place.scrollIntoView({ behavior: reducedMotion() ? "auto" : "smooth" });
  addEventListener("hashchange", () => {
    if (!read(location.hash, model, parts)) return;
    aims.restore();
    cuts.restore();
    all();
  });
  let width = place.clientWidth;
  new ResizeObserver(() => {
    if (place.clientWidth === width || !place.clientWidth) return;
    width = place.clientWidth;
    fit();
    draws.view();
    cuts.draw();
  }).observe(place);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    draws.view();
    cuts.draw();
  });

  return {
    select(wanted) {
      for (const name of [...model.brushes.keys()]) model.change(name, null);
      model.restrict(null);
      for (const [name, told] of Object.entries(wanted ?? {})) {
        const column = study.columns.get(name);
        if (!column || column.role === "detail") throw new RangeError(`there is no axis '${name}'`);
        const brush = brushOf(column, told);
        if (!brush) throw new TypeError(`'${name}' wants [low, high] or a list of names`);
        model.change(name, brush);
      }
      model.counted();
      return model.count;
    },
    selected: () => Array.from(model.rows(), study.numberOfRow),
    pareto: (wanted, limits) => paretoRows(study, wanted, limits).map(study.numberOfRow),
    pin(number) {
      for (let i = 0; i < study.count; i++) if (study.numberOfRow(i) === number) return model.pin(i);
      throw new RangeError(`there is no row ${number}`);
    },
    commands: (row) => [solveCommand(study, row), repeatCommand(study, row)],
    slice: () => cuts.curves(),
    fragment: () => written(model, parts),
  };
}

async function open() {
  const place = document.getElementById("explorer");
  if (!place) return;
  const text = (id) => document.getElementById(id).textContent;
  try {
    const study = await load(JSON.parse(text("explorer-header")), text("explorer-rows"));
    window.trackroller = start(study, place);
    place.dataset.ready = "yes";
  } catch (problem) {
    place.textContent = `The explorer cannot be shown: ${problem.message}. All else on this page stays valid.`;
    place.dataset.ready = "failed";
    throw problem;
  }
}

// Escape closes an enlarged figure as its link Close does: the figure keeps place and focus.
addEventListener("keydown", (event) => {
  if (event.key === "Escape") document.querySelector("figure:target .close")?.click();
});

open();
