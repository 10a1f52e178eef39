// Variants side by side with their differences marked, curves over a parameter, and the case as text.
import { ask } from "./api.js";
import { theme } from "../colours.js";
import { copy, el, replace, select } from "../dom.js";
import { plot } from "../plot.js";
import { scaleOf } from "../scales.js";
import { letter, number } from "../words.js";
import { symbol } from "./fields.js";
import { spectrumView } from "./spectrum.js";

const HEIGHT = 260;

function facts(picture) {
  const found = new Map();
  const add = (group, words, value, unit = "") => found.set(`${group}|${words}`, `${value} ${unit}`.trim());
  for (const { words, value, unit } of picture.inputs) add("Inputs", words, value, unit);
  add("Answer", "headline", `${picture.headline.lead}${picture.headline.rest}`);
  const { contacts, lives } = picture.parts;
  for (const [words, one, two, unit] of contacts?.rows ?? []) add("Contacts 1 / 2", words.text, one.text === two.text ? one.text : `${one.text} / ${two.text}`, unit?.text);
  const place = (name) => picture.limits.heads.findIndex((head) => head.name === name);
  for (const row of picture.limits.rows) add("Used of the limit", `${row[place("limit")].text}, ${row[place("body")]?.text ?? ""}`, row[place("used_low")].text, "%");
  for (const row of picture.limits.rows) if (place("low") >= 0 && row[place("low")].text !== "–") add("Life to the limit", `${row[place("limit")].text}, ${row[place("body")]?.text ?? ""}`, row[place("low")].text, "h");
  const life = (name) => lives?.heads.findIndex((head) => head.name === name) ?? -1;
  for (const row of lives?.rows ?? []) add("Life by fatigue", [row[0].text, life("probability") >= 0 ? `${row[life("probability")].text} % failed` : "", life("basis") >= 0 ? row[life("basis")].text : ""].filter(Boolean).join(", "), life("low") >= 0 ? row[life("low")].text : "", "h");
  return found;
}

export function whatIf(state, offered, { rows }) {
  const pictures = new Map(); // of variants, by their text
  const key = (values) => JSON.stringify(values);

  // variants
  const table = el("div", { class: "wide", tabindex: "0", role: "region", "aria-label": "Variants side by side" });
  const only = el("input", { type: "checkbox", onchange: () => draw() });
  const pin = el("button", { type: "button", onclick: () => state.pin() }, "Pin this roller");
  const told = el("span", { class: "soft" });

  async function solve(values) {
    if (pictures.has(key(values))) return;
    pictures.set(key(values), null);
    try {
      pictures.set(key(values), facts(await ask("picture", { values, accuracy: "standard", complete: true }, key(values))));
    } catch (error) {
      pictures.set(key(values), new Map([["Answer|headline", error.message]]));
    }
    draw();
  }

  function draw() {
    pin.disabled = state.pins.length >= 8;
    told.textContent = state.pins.length ? `${state.pins.length} of 8 variants` : "Pin up to eight variants; they stand in the address, so that a link repeats them.";
    const columns = [...state.pins, state.values].map((values) => pictures.get(key(values)) ?? new Map());
    if (state.tab !== "whatif") return;
    [...state.pins, state.values].forEach(solve);
    const every = [...new Set(columns.flatMap((column) => [...column.keys()]))];
    const groups = [...new Set(every.map((name) => name.split("|")[0]))];
    const names = groups.flatMap((head) => every.filter((name) => name.startsWith(`${head}|`)));
    const heads = state.pins.map((values, i) =>
      el(
        "th",
        { scope: "col" },
        letter(i),
        " ",
        el("button", { type: "button", class: "mini", "aria-label": `Show variant ${letter(i)}`, title: "back to this roller", onclick: () => state.replace(values) }, "show"),
        el("button", { type: "button", class: "mini", "aria-label": `Remove variant ${letter(i)}`, onclick: () => state.unpin(i) }, "✕"),
      ),
    );
    const body = [];
    let group = "";
    for (const name of names) {
      const [head, words] = name.split("|");
      const cells = columns.map((column) => (column.size ? (column.get(name) ?? "–") : "…"));
      const differs = new Set(cells.filter((text) => text !== "…")).size > 1;
      if (only.checked && !differs) continue;
      if (head !== group) body.push(el("tr", { class: "group" }, el("th", { scope: "colgroup", colSpan: columns.length + 1 }, head)));
      group = head;
      body.push(el("tr", { class: differs ? "differs" : "" }, el("th", { scope: "row" }, symbol(words)), cells.map((text, i) => el("td", { class: differs && text !== cells[0] && text !== "…" ? "other" : "" }, text))));
    }
    const head = el("tr", {}, el("th", { scope: "col" }, "quantity"), heads, el("th", { scope: "col" }, "on the screen"));
    replace(table, el("table", { class: "variants" }, el("thead", {}, head), el("tbody", {}, body)));
  }

  // curve
  const numbers = offered.parameters.filter((p) => p.ends || p.optional);
  const over = select("over", numbers.map((p) => [p.name, p.label]), "axial_force", (name) => setOver(name));
  const result = select("Curve of", [], "", () => paint());
  const from = el("input", { type: "text", inputmode: "decimal", "aria-label": "from" });
  const to = el("input", { type: "text", inputmode: "decimal", "aria-label": "to" });
  const curvePlot = plot(HEIGHT, "Curve of a result over a parameter");
  const said = el("p", { class: "soft", role: "status" });
  const values = el("details", {}, el("summary", {}, "The 21 values"));
  let found = null;
  let wanted = "pair_life_to_first_limit_hours";
  for (const field of [from, to]) field.addEventListener("change", () => solveCurve());
  const write_ = (ends) => ([from.value, to.value] = ends.map((end) => String(Number(end.toPrecision(4)))));

  function setOver(name) {
    over.field.value = name;
    const ends = rows.get(name)?.ends?.() ?? offered.parameters.find((p) => p.name === name).ends ?? [1, 10];
    write_(ends);
    solveCurve(true);
  }

  // Ends of a slider that the geometry forbids are drawn in, once.
  async function solveCurve(chosen = false) {
    try {
      const answer = await ask("curve", { values: state.values, over: over.field.value, ends: [Number(from.value), Number(to.value)] });
      found = answer;
      const kept = answer.along.filter((_, i) => Object.values(answer.columns).some((column) => column.values[i] !== null));
      if (chosen && answer.refused && kept.length > 1) {
        write_([kept[0], kept.at(-1)]);
        return solveCurve();
      }
      const names = Object.entries(found.columns);
      wanted = found.columns[result.field.value] ? result.field.value : found.columns[wanted] ? wanted : "roller_life_hours" in found.columns ? "roller_life_hours" : names[0][0];
      replace(result.field, names.map(([name, { label, unit }]) => el("option", { value: name }, unit === "–" ? label : `${label} [${unit}]`)));
      result.field.value = wanted;
      said.textContent = found.refused ? `Some values are refused: ${found.refused}` : "Solved with preview, 21 cases. Choose a value of the curve by its table.";
      paint();
    } catch (error) {
      said.textContent = error.message;
    }
  }

  function paint() {
    if (!found || state.tab !== "whatif") return;
    wanted = result.field.value;
    const column = found.columns[wanted];
    const parameter = offered.parameters.find((p) => p.name === found.over);
    const ends = (list) => list.map((v) => (v === null ? NaN : v === "inf" ? Infinity : v));
    const [along, height] = [ends(found.along), ends(column.values)];
    const finite = height.filter(Number.isFinite);
    const log = finite.length > 0 && Math.min(...finite) > 0 && Math.max(...finite) / Math.min(...finite) > 30;
    const [x, y] = [scaleOf({ name: found.over, values: along }), scaleOf({ name: wanted, values: height, log })];
    curvePlot.fit(Math.max(280, Math.floor(curvePlot.node.parentElement.clientWidth)));
    curvePlot.clear();
    const unit = (words, u) => (u && u !== "–" ? `${words} [${u}]` : words);
    curvePlot.frame(x, y, unit(parameter.label, parameter.unit), unit(column.label, column.unit));
    const { context } = curvePlot;
    const { mark, ink } = theme();
    context.strokeStyle = mark;
    context.lineWidth = 2;
    context.beginPath();
    let open = false;
    height.forEach((value, i) => {
      if (!Number.isFinite(value)) return (open = false);
      const to_ = [curvePlot.x(x.unit(along[i])), curvePlot.y(y.unit(value))];
      open ? context.lineTo(...to_) : context.moveTo(...to_);
      open = true;
    });
    context.stroke();
    const now = Number(state.values[found.over] ?? parameter.value);
    if (now >= Math.min(...along) && now <= Math.max(...along)) {
      context.strokeStyle = ink;
      context.lineWidth = 1;
      context.setLineDash([4, 3]);
      context.beginPath();
      context.moveTo(curvePlot.x(x.unit(now)), 12);
      context.lineTo(curvePlot.x(x.unit(now)), HEIGHT - 44);
      context.stroke();
      context.setLineDash([]);
    }
    curvePlot.node.setAttribute("aria-label", `${column.label} over ${parameter.label}: ${number(height[0])} at ${number(along[0])}, ${number(height.at(-1))} at ${number(along.at(-1))} ${parameter.unit}`);
    const lines = along.map((v, i) => el("tr", {}, el("td", {}, el("button", { type: "button", class: "mini", onclick: () => state.change({ [found.over]: Number(v.toPrecision(4)) }) }, number(v))), el("td", {}, number(height[i]))));
    replace(values, values.firstChild, el("table", {}, el("thead", {}, el("tr", {}, el("th", { scope: "col" }, parameter.label), el("th", { scope: "col" }, column.label))), el("tbody", {}, lines)));
  }

  // how far the parameter of the curve may go
  const relation = select("", [[">=", "at least"], ["<=", "at most"]], ">=", () => {});
  relation.field.setAttribute("aria-label", "Comparison");
  const bound = el("input", { type: "text", inputmode: "decimal", size: 8, "aria-label": "Value that the result has to meet" });
  const far = el("p", { class: "soft", role: "status" }, "Say what the result of the curve has to be, such as 10500.");
  const search = el("button", { type: "button", onclick: () => findRange() }, "How far may it go?");
  const inYears = () => /= 1 year/.test(found?.columns[result.field.value]?.unit ?? "");
  async function findRange() {
    const typed = bound.value.trim().replace(",", ".");
    if (!/^[-+]?[\d.]+(e[-+]?\d+)?(\s*(a|yrs?|years?))?$/i.test(typed)) return (far.textContent = `Write a number that the result of the curve has to meet, such as 10500${inYears() ? " or 3 years" : ""}.`);
    if (!result.field.value) return (far.textContent = "The curve is still being solved: its result is not there yet.");
    far.textContent = "Searching …";
    try {
      far.textContent = (await ask("find_range", { values: state.values, over: over.field.value, condition: `${result.field.value} ${relation.field.value} ${typed}` })).text;
    } catch (error) {
      far.textContent = error.message;
    }
  }

  const loads = spectrumView(state, offered);

  // texts
  const text = el("pre", { tabindex: "0", role: "region", "aria-label": "The case as text" });
  const kind = select("Copy as", ["YAML", "command", "Python"].map((name) => [name, name]), "command", () => write());
  const copied = el("button", { type: "button", onclick: () => copy(text.textContent, copied) }, "Copy");
  async function write() {
    try {
      text.textContent = (await ask("texts", { values: state.values }))[kind.field.value] ?? "";
    } catch (error) {
      text.textContent = error.message;
    }
  }

  const node = el(
    "div",
    { class: "whatif" },
    el("section", {}, el("h2", {}, "Variants"), el("div", { class: "tools" }, pin, el("label", {}, only, " only what differs"), told), table),
    el(
      "div",
      { class: "side" },
      el("section", {}, el("h2", {}, "Curve"), el("div", { class: "tools" }, result.node, over.node, el("label", {}, "from ", from), el("label", {}, "to ", to)), el("div", {}, curvePlot.node), said, el("div", { class: "tools" }, el("span", {}, "Result of the curve"), relation.node, bound, search), far, values),
      loads.node,
      el("section", {}, el("h2", {}, "The roller as text"), el("div", { class: "tools" }, kind.node, copied), text),
    ),
  );
  return {
    // solves the variants again, since a material changed
    forget: () => (pictures.clear(), draw()),
    node,
    curve: (name) => {
      state.show("whatif");
      setOver(name);
    },
    draw() {
      draw();
      if (state.tab !== "whatif") return;
      write();
      loads.draw();
      found ? solveCurve() : setOver(over.field.value);
    },
    redraw: paint,
  };
}
