// Curves of life and stress over one factor: along a grid with the others held, or the running median of a sample.
import { el, replace, select } from "./dom.js";
import { theme } from "./colours.js";
import { plot } from "./plot.js";
import { commonScale, ordered, placesOf, scaleOf } from "./scales.js";
import { count, heading, unitOf } from "./words.js";

const WINDOWS = 24; // places of the running median
const SHARE = 0.12; // part of the rows in one window
const MOST_ROWS = 4000; // rows behind a running median; more rows do not change it visibly
const FEWEST = 8; // rows of the smallest window
const DASHES = [[], [7, 4], [2, 3], [9, 3, 2, 3]];

export function slices(model) {
  const { table: study } = model;
  const factors = study.of("factor");
  const outputs = study.of("output");
  const lives = outputs.filter((c) => c.name.includes("life"));
  const stresses = outputs.filter((c) => c.name.includes("peak_stress"));
  const charts = [lives.length ? lives : outputs.slice(0, 1), stresses.length ? stresses : outputs.slice(1, 2)]
    .filter((list) => list.length)
    .map((list) => list.filter((c) => c.unit === list[0].unit))
    .map((list) => ({ list, scaleY: commonScale(list), base: plot(260, `Curves of ${list.map((c) => c.label).join(", ")}`) }));
  const held = new Map(factors.map((c) => [c.name, c.codes ? Math.floor((c.levels.length - 1) / 2) : 0]));
  const state = { x: (factors.find((c) => c.number && c.codes?.length && c.levels.length > 2) ?? factors[0])?.name ?? "" };
  const rowOf = study.grid ? places() : null;
  const fields = el("div", { class: "tools" });
  const said = el("p", { class: "facts", role: "status", "aria-live": "polite" });
  const node = el("div", { class: "panel" }, fields, said, el("div", { class: "pair" }, charts.map((c) => el("div", {}, c.base.node))));

  // Row of each combination of levels, by mixed radix.
  function places() {
    if (!factors.length || factors.some((c) => !c.codes)) return null;
    const found = new Map();
    for (let i = 0; i < study.count; i++) found.set(key((c) => c.codes[i]), i);
    return found;
  }

  function key(codeOf) {
    let at = 0;
    for (const c of factors) at = at * c.levels.length + codeOf(c);
    return at;
  }

  function controls() {
    if (!factors.length) return;
    const along = select("Along", factors.map((c) => [c.name, c.label]), state.x, (name) => ((state.x = name), model.tell("slice"), controls()));
    const rest = rowOf ? factors.filter((c) => c.name !== state.x).map(holder) : [];
    replace(fields, along.node, rest);
  }

  // A slider for numbers, a list for names.
  function holder(column) {
    const set = (code) => (held.set(column.name, code), model.tell("slice"));
    if (!column.number || column.levels.length < 3) {
      return select(column.label, column.texts.map((text, i) => [String(i), text]), String(held.get(column.name)), (v) => set(Number(v))).node;
    }
    const shown = el("output", {}, valueOf(column, held.get(column.name)));
    const slider = el("input", { type: "range", min: "0", max: String(column.levels.length - 1), step: "1", "aria-label": column.label });
    slider.value = String(held.get(column.name));
    slider.setAttribute("aria-valuetext", shown.textContent);
    slider.addEventListener("input", () => {
      shown.textContent = valueOf(column, Number(slider.value));
      slider.setAttribute("aria-valuetext", shown.textContent);
      set(Number(slider.value));
    });
    return el("label", { class: "slider", "data-factor": column.name }, `${column.label} `, slider, " ", shown);
  }

  const valueOf = (column, code) => `${column.texts[code]}${unitOf(column) ? ` ${unitOf(column)}` : ""}`;

  // Rows along the factor, in the order of its levels.
  function along(column) {
    return column.levels.map((_, i) => rowOf.get(key((c) => (c === column ? i : held.get(c.name)))));
  }

  // Valid selected cases along a factor, at most MOST_ROWS of them.
  function chosen(column) {
    const rows = ordered(column).filter((row) => !model.misses[row] && model.state[row] === 0);
    const step = Math.ceil(rows.length / MOST_ROWS);
    return step > 1 ? rows.filter((_, i) => i % step === 0) : rows;
  }

  // Quartiles of an output in windows over the chosen cases.
  function running(column, output, rows) {
    const [scale, places] = [scaleOf(column), placesOf(column)];
    const known = [...rows].filter((row) => !Number.isNaN(output.values[row]));
    const size = Math.max(FEWEST, Math.round(known.length * SHARE));
    const groups = scale.levels ? levelsOf(column, known) : windows(known, size);
    return groups.filter((g) => g.length).map((group) => {
      const values = Float64Array.from(group, (row) => output.values[row]).sort();
      const at = (q) => values[Math.round(q * (values.length - 1))];
      const middle = group.reduce((sum, row) => sum + places[row], 0) / group.length;
      return { place: middle, low: at(0.25), median: at(0.5), high: at(0.75) };
    });
  }

  const levelsOf = (column, rows) => column.levels.map((_, i) => rows.filter((row) => column.codes[row] === i));

  function windows(rows, size) {
    if (rows.length <= size) return rows.length ? [rows] : [];
    const steps = Math.min(WINDOWS, rows.length - size + 1);
    return Array.from({ length: steps }, (_, k) => {
      const start = Math.round((k * (rows.length - size)) / Math.max(1, steps - 1));
      return rows.slice(start, start + size);
    });
  }

  function draw() {
    const column = study.columns.get(state.x);
    if (!column) return;
    const rows = rowOf ? along(column) : chosen(column);
    for (const { list, base, scaleY } of charts) {
      base.clear();
      const scale = scaleOf(column);
      base.frame(scale, scaleY, heading(column), shortened(list));
      list.forEach((output, k) => (rowOf ? curve : band)(base, scale, scaleY, column, output, rows, k));
      legend(base, list);
    }
    said.textContent = rowOf ? sliceText(column, rows) : `Median and middle half (band) of ${sampleText(rows)} selected cases.`;
  }

  const sampleText = (rows) => (rows.length < model.byState[0] ? `${count(rows.length)} of the ${count(model.byState[0])} valid` : `the ${count(rows.length)} valid`);

  const shortened = (list) => (list.length > 1 ? heading(list[0]).replace(/ (of|in) the (roller|guide)/, "") : heading(list[0]));

  function sliceText(column, rows) {
    const rest = factors.filter((c) => c !== column).map((c) => `${c.label} ${valueOf(c, held.get(c.name))}`);
    const lost = rows.filter((row) => row !== undefined && model.state[row] > 0).map((row) => study.columns.get("state").texts[model.state[row]]);
    const kinds = [...new Set(lost)].map((kind) => `${lost.filter((k) => k === kind).length} ${kind}`);
    return `Held: ${rest.join("; ") || "nothing"}.${kinds.length ? ` Not valid along the curve: ${kinds.join(", ")} (marked below).` : ""}`;
  }

  function curve(base, scaleX, scaleY, column, output, rows, k) {
    const { context } = base;
    const { mark, ink, soft } = theme();
    const points = rows.map((row, i) => [scaleX.levels ? scaleX.unit(i) : scaleX.unit(column.levels[i]), row === undefined ? NaN : scaleY.unit(output.values[row]), row]);
    context.strokeStyle = k ? ink : mark;
    context.fillStyle = k ? ink : mark;
    context.lineWidth = 2;
    context.setLineDash(DASHES[k % DASHES.length]);
    context.beginPath();
    let pen = false;
    for (const [px, py] of points) {
      if (Number.isNaN(py) || Number.isNaN(px)) pen = false;
      else {
        context[pen ? "lineTo" : "moveTo"](base.x(px), base.y(py));
        pen = true;
      }
    }
    context.stroke();
    context.setLineDash([]);
    for (const [px, py, row] of points) {
      if (Number.isNaN(px)) continue;
      context.beginPath();
      context.arc(base.x(px), base.y(py), 3.5, 0, 7);
      const valid = row !== undefined && model.state[row] === 0;
      context.strokeStyle = valid ? context.fillStyle : soft;
      if (valid) context.fill();
      else context.stroke();
    }
  }

  function band(base, scaleX, scaleY, column, output, rows, k) {
    const { context } = base;
    const { mark, ink } = theme();
    const steps = running(column, output, rows);
    const y = (value) => base.y(scaleY.unit(value));
    context.fillStyle = k ? ink : mark;
    context.globalAlpha = 0.18;
    context.beginPath();
    steps.forEach((s, i) => context[i ? "lineTo" : "moveTo"](base.x(s.place), y(s.low)));
    [...steps].reverse().forEach((s) => context.lineTo(base.x(s.place), y(s.high)));
    context.fill();
    context.globalAlpha = 1;
    context.strokeStyle = k ? ink : mark;
    context.lineWidth = 2;
    context.setLineDash(DASHES[k % DASHES.length]);
    context.beginPath();
    steps.forEach((s, i) => context[i ? "lineTo" : "moveTo"](base.x(s.place), y(s.median)));
    context.stroke();
    context.setLineDash([]);
  }

  function legend(base, list) {
    const { context, size } = base;
    const { mark, ink } = theme();
    context.textAlign = "right";
    list.forEach((output, k) => {
      context.fillStyle = ink;
      context.fillText(output.label, size.width - 58, 26 + 15 * k);
      context.strokeStyle = k ? ink : mark;
      context.lineWidth = 2;
      context.setLineDash(DASHES[k % DASHES.length]);
      context.beginPath();
      context.moveTo(size.width - 52, 22 + 15 * k);
      context.lineTo(size.width - 20, 22 + 15 * k);
      context.stroke();
    });
    context.setLineDash([]);
  }

  const medians = (column) => charts.map(({ list }) => list.map((output) => running(column, output, chosen(column))));

  controls();
  return {
    node,
    fit: () => charts.forEach(({ base }) => base.fit(base.node.parentElement.clientWidth)),
    draw,
    values: () => [...held],
    curves: () => (rowOf ? along(study.columns.get(state.x)) : medians(study.columns.get(state.x))),
    state,
    held,
    restore: () => (controls(), draw()),
  };
}
