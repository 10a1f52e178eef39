// The load spectrum of the roller on the screen: loads by share of the time, hours or metres, and what they sum to.
import { ask } from "./api.js";
import { copy, el, replace, select } from "../dom.js";
import { headlineOf, limitTable, part } from "./tables.js";

const BY = [["share", "share of the time"], ["hours", "hours a shift"], ["distance", "metres a shift"]];
const START = [["heavy", "20 %"], ["usual", "50 %"], ["light", "30 %"]]; // shares of a first example
const COLUMNS = [["name", "name"], ["amount", "share of the time"], ["radial_force", "radial force [N]"], ["axial_force", "axial force [N]"]];

export function spectrumView(state, offered) {
  const by = select("Loads by", BY, "share", () => draw());
  const grid = el("div", { class: "wide", tabindex: "0", role: "region", "aria-label": "Loads of the spectrum" });
  const sum = el("button", { type: "button", onclick: () => solve() }, "Sum up");
  const add = el("button", { type: "button", onclick: () => (loads.push({ name: `load ${loads.length + 1}`, amount: "", radial_force: "", axial_force: "" }), draw()) }, "Add a load");
  const told = el("p", { class: "soft", role: "status" }, "Three loads to begin with: the forces on the screen, a half and a quarter of them. Write yours.");
  const answer = el("div", { class: "sums" });
  let loads = [];

  function begin() {
    const now = (name) => Number(state.values[name] ?? offered.parameters.find((p) => p.name === name).value);
    loads = START.map(([name, amount], i) => ({ name, amount, radial_force: String(now("radial_force") / 2 ** i), axial_force: String(now("axial_force") / 2 ** i) }));
  }

  function draw() {
    if (!loads.length) begin();
    const heads = COLUMNS.map(([name, words]) => (name === "amount" ? BY.find(([key]) => key === by.field.value)[1] : words));
    const row = (load, i) =>
      el(
        "tr",
        {},
        COLUMNS.map(([name], j) => el("td", {}, el("input", { type: "text", value: load[name], size: name === "name" ? 10 : 8, "aria-label": `${heads[j]} of load ${i + 1}`, onchange: (event) => (load[name] = event.target.value) }))),
        el("td", {}, loads.length > 1 ? el("button", { type: "button", class: "mini", "aria-label": `Remove load ${i + 1}`, onclick: () => (loads.splice(i, 1), draw()) }, "✕") : null),
      );
    const head = el("tr", {}, heads.map((words) => el("th", { scope: "col" }, words)), el("th", { scope: "col" }, el("span", { class: "hidden" }, "remove")));
    replace(grid, el("table", { class: "blocks" }, el("thead", {}, head), el("tbody", {}, loads.map(row))));
  }

  async function solve() {
    told.textContent = "Solving the loads …";
    try {
      const found = await ask("spectrum", { values: state.values, by: by.field.value, blocks: loads });
      told.textContent = "";
      const text = el("pre", { tabindex: "0", role: "region", "aria-label": "The spectrum file" }, found.text);
      const button = el("button", { type: "button", onclick: () => copy(found.text, button) }, "Copy");
      replace(
        answer,
        el("p", { class: "verdict" }, headlineOf(found.headline)),
        el("ul", { class: "warnings" }, found.warnings.map((words) => el("li", {}, words))),
        Object.entries(found.not_checked).map(([body, names]) => el("p", { class: "soft" }, `not checked, ${body}: ${names.join(", ")}`)),
        found.tables.flatMap((one) => [el("h3", {}, one.title), one.bars ? el("div", { class: "wide" }, limitTable(one)) : part(one)].flat()),
        el("details", {}, el("summary", {}, "The spectrum as a file, for trackroller spectrum"), el("div", { class: "tools" }, button), text),
      );
    } catch (error) {
      told.textContent = error.message;
    }
  }

  return { node: el("section", { class: "spectrum" }, el("h2", {}, "Load spectrum"), el("div", { class: "tools" }, by.node, add, sum), grid, told, answer), draw };
}
