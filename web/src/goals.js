// Goals: two or three outputs, and the Pareto set of the selected cases.
import { copy, el, replace, select } from "./dom.js";
import { paretoRows } from "./pareto.js";
import { byLevels } from "./scales.js";
import { count, heading } from "./words.js";

const WAYS = [["max", "as large as possible"], ["min", "as small as possible"]];

// A brush as comparisons of a study file; null if they cannot say it.
function comparisons(column, brush) {
  if (column.name === "regime") return column.levels.filter((_, code) => !brush.includes(code)).map((name) => `regime != ${name}`);
  if (!column.number || !["factor", "input", "output"].includes(column.role)) return null;
  const name = column.name;
  const between = (low, high) => [low > -Infinity ? `${name} >= ${low}` : "", high < Infinity ? `${name} <= ${high}` : ""].filter(Boolean);
  if (!byLevels(column)) return between(...brush);
  const { levels } = column;
  const above = (code, sign) => (levels[code] === Infinity ? `${name} > ${levels[code - 1]}` : `${name} ${sign} ${levels[code]}`); // no file holds infinity
  if (brush.some((code, i) => i && code !== brush[i - 1] + 1)) return [brush.map((code) => above(code, "==")).join(" or ")];
  return [...(brush[0] ? [above(brush[0], ">=")] : []), ...between(-Infinity, brush.at(-1) < levels.length - 1 ? levels[brush.at(-1)] : Infinity)];
}

export function goals(model) {
  const { table: study } = model;
  const free = [...study.of("output"), ...study.of("factor", "input").filter((c) => c.number)];
  const state = { goals: [] };
  const given = Object.entries(study.goals).filter(([name]) => study.columns.get(name)?.values);
  state.goals = given.length > 1 ? given.slice(0, 3) : free.slice(0, 2).map((c) => [c.name, c.name.includes("life") ? "max" : "min"]);
  const said = el("p", { role: "status", "aria-live": "polite" });
  const question = el("code", {});
  const copied = el("button", { type: "button", "aria-label": "Copy the same question for a study file", onclick: () => copy(question.textContent, copied) }, "Copy");
  const sides = el("div", { class: "tools" });
  const select_ = el("button", { type: "button", onclick: chosen }, "Show the set only");
  const find = el("button", { type: "button", onclick: () => run() }, "Find the Pareto set");
  const away = el("button", { type: "button", onclick: () => (model.mark(null), tell("")) }, "Remove the marks");
  const node = el("div", { class: "panel" }, sides, el("div", { class: "tools" }, find, select_, away), said, el("div", { class: "command" }, el("span", {}, "In a study file"), question, copied));
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
  }

  // Cases that do not roll are no candidates unless a brush on the regime or the state takes them in.
  const wide = () => model.brushes.has("regime") || model.brushes.has("state");
  const own = () => study.columns.has("constraints") && !model.brushes.has("constraints");

  // The same question as keys of a study file.
  function inWords() {
    const found = [...model.brushes].map(([name, brush]) => [study.columns.get(name), comparisons(study.columns.get(name), brush)]);
    const constraints = [...(own() ? study.constraints : []), ...found.flatMap(([, texts]) => texts ?? [])];
    const silent = found.filter(([, texts]) => !texts).map(([column]) => column.label);
    if (model.chosen) silent.push("chosen cases");
    const more = silent.length ? `\n# selected here, but not by a constraint: ${silent.join(", ")}` : "";
    return `pareto: {${state.goals.map(([n, w]) => `${JSON.stringify(n)}: ${w}`).join(", ")}}\nconstraints: [${constraints.map((c) => JSON.stringify(c)).join(", ")}]${more}`;
  }

  function run() {
    try {
      const limits = { ...(wide() ? { regime: ["rolling", "full_slip", "lift_off"] } : {}), ...(own() ? { constraints: ["met"] } : {}) };
      front = paretoRows(study, Object.fromEntries(state.goals), limits, (row) => !model.misses[row]);
    } catch (problem) {
      return tell(`No Pareto set: ${problem.message}.`);
    }
    model.mark(front);
    const cases = front.slice(0, 30).map((row) => study.caseOfRow(row)).join(", ");
    tell(front.length ? `${count(front.length)} cases are beaten by no other selected case: ${cases}${front.length > 30 ? ", …" : ""}.` : "No selected case has a value in every goal.");
  }

  function tell(text) {
    said.textContent = text;
    question.textContent = inWords();
  }

  // The set as a selection: the least ranges that hold it would hold more, so the rows themselves are chosen.
  function chosen() {
    run();
    if (front.length) model.only(front);
  }

  controls();
  tell("");
  return { node, state, draw: () => tell(""), restore: () => (controls(), tell("")) };
}
