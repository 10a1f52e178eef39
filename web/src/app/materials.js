// The materials editor: the values of a material with their sources, and a material of one's own.
import { ask } from "./api.js";
import { el, replace } from "../dom.js";
import { symbol } from "./fields.js";

// `saved(materials, name)` is told after the file of materials was written.
export function materialsEditor(offered, { saved }) {
  const fields = new Map(); // of the values, by name
  let shown = ""; // the material whose values stand in the table
  const choice = el("input", { type: "text", id: "material-like", list: "materials", autocomplete: "off", spellcheck: false });
  const name = el("input", { type: "text", id: "material-name", autocomplete: "off", spellcheck: false, placeholder: "C45 of our supplier" });
  const source = el("input", { type: "text", id: "material-source", autocomplete: "off", placeholder: "data sheet or test" });
  const table = el("div", { class: "wide", tabindex: "0", role: "region", "aria-label": "Values of the material" });
  const said = el("p", { class: "said", role: "status" });
  const save = el("button", { type: "button", onclick: store }, "Save the material");
  const row = (id, text, field) => el("div", { class: "field words" }, el("label", { for: id }, text), field);
  const node = el(
    "details",
    { class: "materials" },
    el("summary", {}, "Materials: look up, change, add"),
    row("material-like", "Material", choice),
    table,
    row("material-name", "Name to save it under", name),
    row("material-source", "Source of the changed values", source),
    save,
    said,
  );
  node.addEventListener("toggle", () => node.open && !shown && look(offered.materials[0].name));
  choice.addEventListener("change", () => look(choice.value.trim()));

  function complain(error) {
    said.textContent = error.message;
    said.classList.add("wrong");
  }

  async function look(wanted) {
    let found;
    try {
      found = await ask("material", { name: wanted });
    } catch (error) {
      return complain(error);
    }
    said.textContent = `${found.family}: ${found.description}`;
    said.classList.remove("wrong");
    shown = choice.value = wanted;
    name.value = wanted;
    fields.clear();
    const lines = found.rows.map((value) => {
      const field = el("input", { type: "text", inputmode: "decimal", autocomplete: "off", "aria-label": `${value.label} [${value.unit}]`, "data-material": value.field });
      field.value = value.value;
      fields.set(value.field, { field, before: value.value });
      return el("tr", {}, el("th", { scope: "row" }, value.label, " ", symbol(value.symbol)), el("td", {}, field), el("td", {}, value.unit === "-" ? "" : value.unit), el("td", {}, value.source), el("td", {}, value.mark));
    });
    const head = ["value of", "number", "unit", "source", "remark"].map((text) => el("th", { scope: "col" }, text));
    replace(table, el("table", {}, el("thead", {}, el("tr", {}, head)), el("tbody", {}, lines)));
  }

  async function store() {
    const values = Object.fromEntries([...fields].filter(([, { field, before }]) => field.value.trim() !== before).map(([key, { field }]) => [key, field.value]));
    const own = name.value.trim();
    try {
      const answer = await ask("save_material", { name: own, like: shown, values, source: source.value });
      saved(answer.materials, own);
      await look(own);
      said.textContent = [`${own} stands in ${answer.file}.`, ...answer.doubts].join(" ");
    } catch (error) {
      complain(error);
    }
  }

  return { node };
}
