// Tables of a record: the limits with their bars, and further ones; heads hold their definitions.
import { el } from "../dom.js";
import { symbol } from "./fields.js";

export function drawn(text) {
  const svg = new DOMParser().parseFromString(text, "text/html").querySelector("svg");
  return document.importNode(svg, true);
}

// A further table of the record: texts by row, with the definition of each head.
export function part({ title, heads, rows, shared, note }) {
  const unit = ({ title, unit: of }) => (of ? `${title} [${of}]` : title);
  const right = ({ kind }) => (kind.split(" ").includes("n") ? "n" : "");
  const head = el("tr", {}, heads.map((one) => el("th", { scope: "col", class: right(one), title: one.meaning }, unit(one))));
  const body = rows.map((row) => el("tr", {}, row.map(({ text }, i) => (i ? el("td", { class: right(heads[i]) }, symbol(text)) : el("th", { scope: "row" }, symbol(text))))));
  const said = [shared.length ? `All rows: ${shared.join(", ")}.` : "", note].filter(Boolean).join(" ");
  return [el("div", { class: "wide", tabindex: "0", role: "region", "aria-label": title }, el("table", { class: "lines numbers" }, el("thead", {}, head), el("tbody", {}, body))), said ? el("p", { class: "soft" }, said) : null];
}

export function limitTable({ heads, rows, bars, axis }, complete = true) {
  const unit = ({ title, unit: of }) => (of ? `${title} [${of}]` : title);
  const used = heads.findIndex(({ name }) => name === "used_low");
  const now = heads.findIndex(({ name }) => name === "value");
  const shown = heads.map((_, i) => i).filter((i) => i !== now);
  const head = shown.flatMap((i) => [el("th", { scope: "col", title: heads[i].meaning, class: heads[i].kind }, unit(heads[i])), i === used && axis ? el("td", { class: "bars" }, drawn(axis)) : null]);
  const body = rows.map((row, at) =>
    el(
      "tr",
      { title: `${row[0].text}: ${now < 0 ? "" : row[now].text}` },
      shown.flatMap((i) => [i ? el("td", { class: `${heads[i].kind} ${row[i].state}` }, row[i].text) : el("th", { scope: "row" }, row[i].text), i === used && bars.length ? el("td", { class: "bars" }, drawn(bars[at])) : null]),
    ),
  );
  return [el("table", { class: "margins" }, el("thead", {}, el("tr", {}, head)), el("tbody", {}, body)), complete ? null : el("p", { class: "soft" }, "The distances to slip and lift-off follow when it rests.")];
}

// Some columns of a further table, by name.
export function columnsOf(table, names) {
  const kept = table.heads.map((_, i) => i).filter((i) => names.includes(table.heads[i].name));
  return { ...table, heads: kept.map((i) => table.heads[i]), rows: table.rows.map((row) => kept.map((i) => row[i])) };
}

// A headline: the answer itself in bold, and what follows it.
export const headlineOf = ({ lead, rest }) => [el("b", {}, lead), rest];
