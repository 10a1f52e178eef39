// The same brushes as fields: limits for numbers, boxes for levels. They work with keys and with a screen reader.
import { el } from "./dom.js";
import { byLevels } from "./scales.js";
import { heading } from "./words.js";

const MOST_BOXES = 40;

// Choices and conditions apart where designs repeat; designs and conditions themselves stand in lists.
function groups(study) {
  const { design } = study.lists;
  const factors = study.of("factor");
  const chosen = (column) => design.factors.includes(column.name);
  const states = study.of("state").filter((c) => !c.name.startsWith("validity") && c.name !== "reason");
  const first = design ? [["Choices", factors.filter(chosen)], ["Conditions of use", factors.filter((c) => !chosen(c))]] : [["Factors", factors]];
  return [...first, ["Results", [...study.of("output"), ...study.of("design").filter((c) => !c.codes)]], ["State", states]];
}

export function brushes(model) {
  const fields = new Map();
  const node = el("div");

  function numbers(column) {
    const [low, high] = ["from", "to"].map((word) =>
      el("input", { type: "number", step: "any", "aria-label": `${column.label}, ${word}`, onchange: changed }),
    );
    function changed() {
      const [a, b] = [low.value === "" ? -Infinity : Number(low.value), high.value === "" ? Infinity : Number(high.value)];
      model.brush(column.name, low.value === "" && high.value === "" ? null : [a, b]);
    }
    const show = (brush) => {
      low.value = brush && Number.isFinite(brush[0]) ? String(Number(brush[0].toPrecision(6))) : "";
      high.value = brush && Number.isFinite(brush[1]) ? String(Number(brush[1].toPrecision(6))) : "";
    };
    return { parts: [el("span", { class: "limits" }, low, " to ", high)], show };
  }

  function boxes(column) {
    const all = column.texts.slice(0, MOST_BOXES).map((text, code) => {
      const box = el("input", { type: "checkbox", checked: true, onchange: changed });
      return { box, code, node: el("label", {}, box, ` ${text}`) };
    });
    function changed() {
      const kept = all.filter((b) => b.box.checked).map((b) => b.code);
      model.brush(column.name, kept.length === all.length ? null : kept);
    }
    return { parts: all.map((b) => b.node), show: (brush) => all.forEach((b) => (b.box.checked = !brush || brush.includes(b.code))) };
  }

  for (const [words, columns] of groups(model.table)) {
    if (!columns.length) continue;
    const sets = columns.map((column) => {
      const field = byLevels(column) ? boxes(column) : numbers(column);
      fields.set(column.name, field);
      return el("fieldset", {}, el("legend", {}, heading(column)), field.parts);
    });
    node.append(el("h4", {}, words), el("div", { class: "brushes" }, sets));
  }

  return { node, draw: () => fields.forEach((field, name) => field.show(model.brushes.get(name))) };
}
