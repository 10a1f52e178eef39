// The explorer: linked views of the cases of a study, and `window.trackroller` for scripts.
import { written, read, isOurs } from "./address.js";
import { brushes } from "./brushes.js";
import { cards, repeatCommand, solveCommand } from "./cards.js";
import { SHAPES, colouring } from "./colours.js";
import { load } from "./data.js";
import { el, reducedMotion, replace, select } from "./dom.js";
import { goals } from "./goals.js";
import { histogram } from "./histogram.js";
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

function counts(model) {
  const shown = (name) => el("data", { "data-count": name }, "0");
  const [selected, valid, left] = ["selected", "valid", "left-out"].map(shown);
  const why = el("span", { class: "facts" });
  const clear = el("button", { type: "button", onclick: () => model.clear() }, "Clear the selection");
  const node = el("div", { class: "counts", role: "status", "aria-live": "polite" });
  node.append(el("span", {}, selected, ` of ${count(model.table.count)} cases selected`), el("span", {}, valid, " valid"), el("span", {}, left, " left out ", why), clear);
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
      const told = model.table.states.map((name, i) => [name, model.byState[i]]).slice(1).filter(([, n]) => n);
      why.textContent = told.length ? `(${told.map(([name, n]) => `${count(n)} ${name}`).join(", ")})` : "";
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

function start(study, place) {
  const model = new Model(study);
  const [factors, outputs] = [study.of("factor"), study.of("output")];
  const first = outputs.filter((c) => !Number.isNaN(scaleOf(c).low) && scaleOf(c).known !== false);
  const shown = (first.length ? first : outputs).slice(0, FIRST_OUTPUTS);
  const y = shown[0] ?? factors[1] ?? factors[0] ?? study.columns.get("state");
  const x = factors.find((c) => c.number) ?? factors[0] ?? study.columns.get("regime");
  Object.assign(model.views, { x: x.name, y: y.name, histogram: y.name, axes: [...factors, ...shown].map((c) => c.name).concat("regime", "state", study.columns.has("constraints") ? "constraints" : []) });

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
  const key = legend(model, colours);
  const parts = { goals: aims, slices: cuts, table: list };

  const every = study.of("factor", "input", "output", "state").filter((c) => c.name !== "reason" && !c.name.startsWith("validity"));
  const options = every.map((c) => [c.name, heading(c)]);
  const choose = (words, view) => select(words, options, model.views[view], (name) => model.view(view, name));
  const choices = { x: choose("Across", "x"), y: choose("Up", "y"), colour: choose("Colour", "colour"), histogram: choose("Histogram of", "histogram") };
  const axisBoxes = every.map((column) => {
    const box = el("input", { type: "checkbox", "data-axis": column.name });
    box.addEventListener("change", () => {
      const kept = new Set(model.views.axes);
      if (box.checked) kept.add(column.name);
      else kept.delete(column.name);
      model.view("axes", every.map((c) => c.name).filter((name) => kept.has(name)));
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
    el("p", { class: "facts" }, "Drag along an axis to select; click a level or an empty axis to take it back. Every field below works with the keyboard as well."),
    key.node,
    lines.node,
    note,
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
    points: () => aims.points(),
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
