// Designs and conditions as lists: a box selects all cases of an entry. They work with keys and with a screen reader.
import { el } from "./dom.js";
import { count } from "./words.js";

const WORDS = { design: ["Design", "Designs, the best first"], condition: ["Condition", "Conditions, the hardest first"] };
const MEANT = {
  design: "A design is one combination of choices. Its worst life is that of the conditions in which it is valid.",
  condition: "A condition is one combination of what nobody chooses. The hardest one leaves the fewest valid designs.",
};

function list(model, name, { heads, rows, of, note }) {
  const [one, many] = WORDS[name];
  const boxes = rows.map((_, i) => el("input", { type: "checkbox", "aria-label": `${one} ${i + 1}`, onchange: changed }));
  const lines = rows.map((cells, i) => el("tr", {}, el("td", {}, boxes[i]), el("th", { scope: "row" }, count(i + 1)), cells.map((text) => el("td", {}, text))));
  const head = el("tr", {}, el("td", {}), el("th", { scope: "col" }, one), heads.map((text) => el("th", { scope: "col" }, text)));
  const table = el("table", {}, el("thead", {}, head), el("tbody", {}, lines));
  const part = rows.length < of ? `The first ${count(rows.length)} of ${count(of)} are listed; the axis holds all of them.` : "";
  const facts = [MEANT[name], note, part].filter(Boolean).join(" ");
  const region = el("div", { class: "wide list", tabindex: "0", role: "region", "aria-label": many }, table);
  function changed() {
    const kept = boxes.flatMap((box, i) => (box.checked ? [i] : []));
    model.brush(name, kept.length ? kept : null);
  }
  return {
    node: el("details", { open: name === "design", "data-list": name }, el("summary", {}, `${many} (${count(of)})`), el("p", { class: "facts" }, facts), region),
    draw() {
      const brush = new Set(model.brushes.get(name));
      boxes.forEach((box, i) => {
        box.checked = brush.has(i);
        lines[i].classList.toggle("chosen", box.checked);
      });
    },
  };
}

export function lists(model) {
  const parts = Object.entries(model.table.lists).map(([name, entries]) => list(model, name, entries));
  return { nodes: parts.map((part) => part.node), draw: () => parts.forEach((part) => part.draw()) };
}
