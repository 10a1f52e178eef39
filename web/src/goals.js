// Goals: limits and two or three outputs, and the Pareto set within the limits.
import { numberOf } from "./data.js";
import { copy, el, replace, select } from "./dom.js";
import { frontOf, paretoRows } from "./pareto.js";
import { count, heading, number } from "./words.js";

const WAYS = [["max", "as large as possible"], ["min", "as small as possible"]];

// Design points of a study whose goals are statistics over scatter: the points that no other beats, as a table.
function designPoints(model) {
  const { points, columns } = model.table;
  if (!points) return { node: null, front: () => [] };
  const told = Object.entries(points.goals).map(([name, way]) => `${points.labels[name] ?? name} ${way === "max" ? "up" : "down"}`).join(", ");
  const text = `The goals of this study are statistics over its scatter: ${told}. They compare design points, not single cases.`;
  if (!points.values) return { node: el("p", {}, `${text} Their Pareto set needs sensitivity.nc beside the study; it stands in report.html under Decide.`), front: () => [] };
  const names = Object.keys(points.goals);
  const list = names.map((name) => points.values[name].map(numberOf));
  const costs = list.map((values, k) => (points.goals[names[k]] === "min" ? values : values.map((v) => -v)));
  const front = () => frontOf(costs, list[0].keys());
  const cases = (i) => {
    const tests = points.factors.map((name) => [columns.get(name), numberOf(points.values[name][i])]);
    const inside = (row) => tests.every(([c, v]) => (c.values ? c.values[row] === v : c.levels[c.codes[row]] === v));
    return Array.from({ length: model.table.count }, (_, row) => row).filter(inside);
  };
  const shown = [...points.factors, ...names.filter((name) => !points.factors.includes(name))];
  const cell = (value) => (typeof value === "number" ? number(value) : String(value));
  const rows = front().map((i) => el("tr", {}, shown.map((name) => el("td", {}, cell(numberOf(points.values[name][i])))), el("td", {}, el("button", { type: "button", "aria-label": `Show the cases of design point ${i}`, onclick: () => model.only(cases(i)) }, "Show its cases"))));
  const head = el("thead", {}, el("tr", {}, shown.map((name) => el("th", { scope: "col" }, points.labels[name] ?? name)), el("td", {})));
  const wide = el("div", { class: "wide", tabindex: "0", role: "region", "aria-label": "Pareto-optimal design points" }, el("table", {}, head, el("tbody", {}, rows)));
  return { node: el("div", { class: "points" }, el("p", {}, `${text} ${count(rows.length)} of ${count(list[0].length)} are beaten by no other; the fields below compare single cases.`), wide), front };
}

export function goals(model) {
  const { table: study } = model;
  const free = [...study.of("output"), ...study.of("factor", "input").filter((c) => c.number)];
  const state = { goals: [], limits: {}, regimes: ["rolling"], own: study.columns.has("constraints") };
  const given = Object.entries(study.goals).filter(([name]) => study.columns.get(name)?.values);
  state.goals = given.length > 1 ? given.slice(0, 3) : free.slice(0, 2).map((c) => [c.name, c.name.includes("life") ? "max" : "min"]);
  const said = el("p", { role: "status", "aria-live": "polite" });
  const question = el("code", {});
  const copied = el("button", { type: "button", "aria-label": "Copy the same question for a study file", onclick: () => copy(question.textContent, copied) }, "Copy");
  const sides = el("div", { class: "tools" });
  const limits = el("div", { class: "tools" });
  const select_ = el("button", { type: "button", onclick: chosen }, "Show the set only");
  const find = el("button", { type: "button", onclick: () => run() }, "Find the Pareto set");
  const away = el("button", { type: "button", onclick: () => (model.mark(null), tell("")) }, "Remove the marks");
  const points = designPoints(model);
  const node = el("div", { class: "panel" }, points.node ?? "", sides, limits, el("div", { class: "tools" }, find, select_, away), said, el("div", { class: "command" }, el("span", {}, "In a study file"), question, copied));
  let front = [];

  function controls() {
    const options = [["", "–"], ...free.map((c) => [c.name, heading(c)])];
    const three = [0, 1, 2].map((k) => {
      const [name, way] = state.goals[k] ?? ["", "min"];
      const set = (value) => {
        if (value[0]) state.goals[k] = value;
        else state.goals.splice(k, 1);
        controls();
      };
      const which = select(`Goal ${k + 1}`, options, name, (v) => set([v, state.goals[k]?.[1] ?? "min"]));
      const how = select("", WAYS, way, (v) => set([state.goals[k]?.[0] ?? "", v]));
      how.field.setAttribute("aria-label", `Direction of goal ${k + 1}`);
      return el("span", { class: "goal" }, which.node, how.node);
    });
    replace(sides, three);
    const shown = free.filter((c) => c.role === "output");
    const fields = shown.map((column) => {
      const [low, high] = [0, 1].map((side) => {
        const field = el("input", { type: "number", step: "any", "aria-label": `${column.label}, ${side ? "at most" : "at least"}` });
        field.value = state.limits[column.name]?.[side] ?? "";
        field.addEventListener("change", () => {
          const pair = state.limits[column.name] ?? [null, null];
          pair[side] = field.value === "" ? null : Number(field.value);
          state.limits[column.name] = pair;
          if (pair[0] === null && pair[1] === null) delete state.limits[column.name];
        });
        return field;
      });
      return el("fieldset", {}, el("legend", {}, heading(column)), el("span", { class: "limits" }, "≥ ", low, " ≤ ", high));
    });
    const regime = study.columns.get("regime");
    const boxes = regime.levels.slice(0, 3).map((name, i) => {
      const box = el("input", { type: "checkbox", checked: state.regimes.includes(name) });
      box.addEventListener("change", () => {
        state.regimes = regime.levels.filter((n) => (n === name ? box.checked : state.regimes.includes(n)));
      });
      return el("label", {}, box, ` ${regime.texts[i]}`);
    });
    const own = el("input", { type: "checkbox", checked: state.own, onchange: () => (state.own = own.checked) });
    const told = study.columns.has("constraints") ? el("fieldset", {}, el("legend", {}, "Constraints of the study"), el("label", {}, own, ` ${study.constraints.join("; ")}`)) : null;
    replace(limits, fields, el("fieldset", {}, el("legend", {}, "Regimes allowed"), boxes), told ?? []);
  }

  const usual = () => state.regimes.length === 1 && state.regimes[0] === "rolling";

  function asked() {
    return { ...state.limits, ...(usual() ? {} : { regime: state.regimes }), ...(state.own ? { constraints: ["met"] } : {}) };
  }

  // The same question as keys of a study file.
  function inWords() {
    const constraints = [...(state.own ? study.constraints : []), ...Object.entries(state.limits).flatMap(([name, [low, high]]) => [
      ...(low === null ? [] : [`${name} >= ${low}`]),
      ...(high === null ? [] : [`${name} <= ${high}`]),
    ])];
    if (!usual()) for (const name of ["rolling", "full_slip", "lift_off"]) if (!state.regimes.includes(name)) constraints.push(`regime != ${name}`);
    if (!usual() && state.regimes.length === 3) constraints.push("regime != failed");
    return `pareto: {${state.goals.map(([n, w]) => `${JSON.stringify(n)}: ${w}`).join(", ")}}\nconstraints: [${constraints.map((c) => JSON.stringify(c)).join(", ")}]`;
  }

  function run() {
    try {
      front = paretoRows(study, Object.fromEntries(state.goals), asked());
    } catch (problem) {
      return tell(`No Pareto set: ${problem.message}.`);
    }
    model.mark(front);
    const cases = front.slice(0, 30).map((row) => study.caseOfRow(row)).join(", ");
    tell(front.length ? `${count(front.length)} cases are beaten by no other within the limits: ${cases}${front.length > 30 ? ", …" : ""}.` : "No case meets the limits.");
  }

  function tell(text) {
    said.textContent = text;
    question.textContent = inWords();
  }

  // The set as a selection: the least ranges that hold it would hold more, so the rows themselves are chosen.
  function chosen() {
    if (!model.marked) run();
    if (front.length) model.only(front);
  }

  controls();
  tell("");
  return { node, state, run, points: points.front, restore: () => (controls(), tell("")) };
}
