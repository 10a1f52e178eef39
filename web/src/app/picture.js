// What is seen of one case: headline, drawing, maps, tables, margins, lives and warnings.
import { el, replace, select } from "../dom.js";
import { maps } from "./patch.js";
import { columnsOf, drawn, headlineOf, limitTable, part } from "./tables.js";

const KINDS = [
  ["pressure", "pressure"],
  ["shear", "shear traction"],
  ["roller", "von Mises below, roller"],
  ["guide", "von Mises below, guide"],
];
const LIFE = ["body", "probability", "low", "km_low", "cycles_low", "extrapolated", "why"]; // columns beside the fields; the sheet has the others
const FEW = 4; // warnings that stand on one screen, in one line each until they are asked for in full
const SHOWN = { preview: "preview while it moves", standard: "standard" };

export function pictureView({ again }) {
  const verdict = el("p", { class: "verdict", role: "status", "aria-live": "polite" });
  const stage = el("span", { class: "stage" });
  const warnings = el("ul", { class: "warnings" });
  const full = el("button", { type: "button", class: "mini full", hidden: true, "aria-pressed": "false", onclick: () => fold(full.getAttribute("aria-pressed") !== "true") });
  // Warnings stand in full where the screen has room for them, or on request.
  function fold(all = full.getAttribute("aria-pressed") === "true") {
    const items = [...warnings.children];
    const shorten = (short) => {
      warnings.classList.toggle("short", short);
      items.forEach((item, i) => (item.hidden = short && i >= FEW));
    };
    shorten(false);
    const tight = matchMedia("(min-width: 60rem)").matches && document.documentElement.scrollHeight > innerHeight;
    shorten(tight && !all);
    full.hidden = !tight;
    full.setAttribute("aria-pressed", String(all));
    full.textContent = items.length > FEW ? `all ${items.length} warnings in full` : "warnings in full";
  }
  const drawing = el("div", { class: "drawing-place" });
  const map = maps();
  let kind = "pressure";
  let last = null;
  const inside = () => kind === "roller" || kind === "guide";
  const choice = select("Map", KINDS, kind, (value) => {
    kind = value;
    if (inside() && !last?.sections.length) again();
    else draw();
  });
  const tables = el("div", {});
  const limits = el("div", {});
  const lives = el("div", {});
  const whole = el("details", { class: "whole" }, el("summary", {}, "Slip, and loads on the bearing"));
  const unchecked = el("details", {}, el("summary", {}, "Not checked, and placeholders"));
  const section = (title, ...content) => el("section", {}, el("h2", {}, title), ...content);
  const node = el(
    "div",
    { class: "picture" },
    el("div", { class: "head" }, verdict, el("div", { class: "stages" }, stage, full), warnings),
    el("div", { class: "left" }, section("Roller and guide, to scale", drawing), section("Contact patches", choice.node, map.node), whole, unchecked),
    el("div", { class: "right" }, section("Contacts", tables), section("Margins, the first limit first", limits)),
  );

  function draw() {
    if (!last) return;
    if (!inside()) map.patches(last.patches, kind);
    else if (last.sections.length) map.sections(last.sections, kind);
  }

  return {
    node,
    lives: section("Life by fatigue", lives),
    inside,
    redraw: () => (fold(), draw()),
    show(picture, unworn) {
      if (last && picture.accuracy === "standard" && !picture.sections.length && inside()) picture.sections = last.sections;
      last = picture;
      replace(verdict, headlineOf(picture.headline));
      stage.textContent = `shown: ${SHOWN[picture.accuracy] ?? picture.accuracy}${unworn ? ", before the travel; wear follows at rest, after seconds" : ""}`;
      stage.dataset.stage = picture.complete ? "complete" : picture.accuracy;
      node.classList.toggle("preview", picture.accuracy === "preview");
      replace(warnings, picture.warnings.map(([head, text]) => el("li", { title: text }, el("strong", {}, `${head}:`), " ", text)));
      replace(drawing, drawn(picture.drawing));
      const { contacts, whole: quantities, lives: told, placeholders } = picture.parts;
      replace(tables, contacts ? part(contacts) : el("p", {}, picture.answer.facts.reason || "No values: a contact has lifted off."));
      replace(limits, limitTable(picture.limits, picture.complete));
      replace(lives, told ? part(columnsOf(told, LIFE)) : null);
      replace(whole, whole.firstChild, quantities ? part(quantities) : null);
      const missing = Object.entries(picture.not_checked).map(([body, names]) => `${body}: ${names.join(", ")}`);
      const unused = Object.entries(picture.not_used).map(([name, why]) => `given, but not used: ${name}, ${why}`);
      replace(unchecked, unchecked.firstChild, el("ul", {}, [...missing, ...unused].map((text) => el("li", {}, text))), placeholders ? part(placeholders) : null);
      draw();
      fold();
    },
    refuse(errors) {
      verdict.textContent = "Not solved. Mend the marked field.";
      stage.textContent = "shown: the last case that could be solved";
      stage.dataset.stage = "refused";
      replace(warnings, errors.map((error) => el("li", {}, error.message)));
      warnings.classList.remove("short");
      full.hidden = true;
      node.classList.add("preview");
    },
  };
}
