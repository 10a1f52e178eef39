// From a requirement to the least roller of a shelf: loads or a carriage, rail, duty, and what has to hold.
import { ask } from "./api.js";
import { el, replace } from "../dom.js";

const CASE = ["radial_force", "axial_force", "motor_force", "velocity", "friction_coefficient", "guide_profile_radius", "guide_curve_radius", "contact_angle", "guide_overrollings_per_hour"];
const REQUIRED = [["life", "Life", "such as 3 years beside a duty, or hours"], ["failures", "Failures by then", "such as 5 %; a typical scatter where the materials state none"], ["safety", "Safety against overload", "factor on all forces within all limits, such as 1.5"], ["temperature", "Permissible temperature [degC]", "of roller and guide, such as 60 degC; needs the heat transfer of the roller"], ["wear_depth", "Permissible wear depth [mm]", "within the required life, such as 0.05 mm"], ["least", "Least", "column of the shelf, such as price; without one the longest life leads"]];

export function requirementView(state, offered, { duty }) {
  const own = { carriage: "", shelf: "", required: Object.fromEntries(REQUIRED.map(([name]) => [name, ""])) };
  const lists = { shelf: el("datalist", { id: "shelf-files" }), carriage: el("datalist", { id: "carriage-choice" }) };
  const text = (label, help, value, change, list = null) => {
    const input = el("input", { type: "text", value, "aria-label": label, title: help, list, onchange: () => change(input.value.trim()) });
    return { input, node: el("label", { class: "asked-for", title: help }, el("span", {}, label), input) };
  };
  const given = CASE.map((name) => {
    const one = offered.parameters.find((p) => p.name === name);
    const unit = one.unit && one.unit !== "-" ? ` [${one.unit}]` : "";
    const row = text(`${one.label}${unit}`, one.meaning, "", (value) => state.change({ [name]: value || null }));
    row.input.placeholder = one.value === null ? "" : String(one.value);
    return { ...row, name };
  });
  const guide = text("Guide material", "a name of the database", "", (value) => state.change({ guide_material: value || null }), "materials");
  const dutyRows = duty.map(([name, label, help, get, set]) => ({ ...text(label, help, "", (value) => set(value || null)), name, get }));
  const carriage = text("Carriage file, in place of these loads", "a carriage file of this folder; its rollers' files give rail and duty", "", (value) => ((own.carriage = value), draw()), "carriage-choice");
  const shelf = text("Shelf: a table of rollers", "CSV or .xlsx of this folder: name, dimensions as parameters, price", "", (value) => (own.shelf = value), "shelf-files");
  const required = REQUIRED.map(([name, label, help]) => text(label, help, "", (value) => (own.required[name] = value)));
  const told = el("p", { class: "soft", role: "status" });
  const button = el("button", { type: "button", class: "main", onclick: () => solve() }, "Find the roller");
  const answer = el("div", { class: "sizes" });
  const loads = el("fieldset", {}, el("legend", {}, "Loads, rail and duty"), [...given, guide, ...dutyRows].map((row) => row.node));
  let asked = 0;

  function draw() {
    for (const row of given) row.input.value = state.values[row.name] ?? "";
    guide.input.value = state.values.guide_material ?? "";
    for (const row of dutyRows) row.input.value = row.get() ?? "";
    loads.disabled = own.carriage !== "";
  }

  async function look() {
    draw();
    const found = await ask("carriage_files");
    const options = (names) => names.map((name) => el("option", { value: name }));
    replace(lists.shelf, options(found.tables));
    replace(lists.carriage, options(found.files));
    if (!own.shelf && found.tables.length === 1) [own.shelf] = [(shelf.input.value = found.tables[0])];
    if (!found.tables.length) told.textContent = "No table stands in this folder. trackroller shelf --example rollers.csv writes one to fill in.";
  }

  // A first answer in preview, then the one that counts.
  async function solve() {
    const number = ++asked;
    for (const accuracy of ["preview", "standard"]) {
      told.textContent = accuracy === "preview" ? "Solving the rollers …" : "A first answer, in preview. Solving at standard accuracy …";
      try {
        const found = await ask("sized", { values: state.values, ...own, accuracy });
        if (number !== asked) return;
        show(found, accuracy);
      } catch (error) {
        if (number !== asked) return;
        replace(answer);
        told.textContent = error.message;
        return;
      }
      if (own.carriage) break; // its files state the accuracy
    }
    told.textContent = "";
  }

  function show(found, accuracy) {
    const table = (one, states, title) =>
      el(
        "div",
        { class: "wide", tabindex: "0", role: "region", "aria-label": title },
        el(
          "table",
          { class: "cards", "data-accuracy": accuracy },
          el("thead", {}, el("tr", {}, one.heads.map((head) => el("th", { scope: "col" }, head)))),
          el("tbody", {}, one.rows.map((row, i) => el("tr", { class: row[0] === found.least ? "least" : "" }, row.map((cell, j) => (j ? el("td", { "data-head": one.heads[j], class: one.heads[j] === "verdict" ? states[i] : "" }, cell) : el("th", { scope: "row" }, cell)))))),
        ),
      );
    replace(
      answer,
      el("p", { class: "verdict" }, el("b", {}, found.lead)),
      el("ul", { class: "sentences" }, found.notes.map((words) => el("li", {}, words))),
      el("h2", {}, "Rollers"),
      table(found.tables[0], found.states, "Rollers of the shelf"),
      found.tables.slice(1).flatMap((one) => [el("h2", {}, "All forces times, until a limit is at 100 %"), table(one, [], "Load ratios")]),
    );
  }

  const node = el(
    "div",
    { class: "requirement" },
    el("form", { class: "asking", "aria-label": "Requirement", onsubmit: (event) => event.preventDefault() }, el("fieldset", {}, el("legend", {}, "Requirement"), required.map((row) => row.node)), el("fieldset", {}, el("legend", {}, "Rollers"), shelf.node, carriage.node, lists.shelf, lists.carriage), loads, el("div", { class: "tools" }, button), told),
    answer,
  );
  return { node, look, draw };
}
