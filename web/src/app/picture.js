// What is seen of one case: verdict, drawing, maps, tables, margins, lives and warnings.
import { el, replace, select } from "../dom.js";
import { symbol } from "./fields.js";
import { maps } from "./patch.js";

const FULL = 150; // percent of a limit at the right end of a bar, as on the sheet
const KINDS = [
  ["pressure", "pressure"],
  ["shear", "shear traction"],
  ["roller", "von Mises below, roller"],
  ["guide", "von Mises below, guide"],
];
const FEW = 4; // warnings that stand on one screen, in one line each until they are asked for in full
const SHOWN = { preview: "preview while it moves", standard: "standard" };

function drawn(text) {
  const svg = new DOMParser().parseFromString(text, "text/html").querySelector("svg");
  return document.importNode(svg, true);
}

function rows(list) {
  return el("table", {}, el("tbody", {}, list.map(({ words, value, unit }) => el("tr", {}, el("th", { scope: "row" }, symbol(words)), el("td", {}, value), el("td", { class: "unit" }, unit)))));
}

function lines(list) {
  const head = el("tr", {}, ["quantity", "contact 1", "contact 2", "unit"].map((text) => el("th", { scope: "col" }, text)));
  const body = list.map(([words, one, two, unit]) => el("tr", {}, el("th", { scope: "row" }, symbol(words)), el("td", {}, one), el("td", {}, two), el("td", { class: "unit" }, unit)));
  return el("table", { class: "lines" }, el("thead", {}, head), el("tbody", {}, body));
}

const BEYOND = " (beyond the S-N data)"; // a dagger in the table stands for it

function bar(margin) {
  if (!margin.share) return el("span", { class: "soft" }, margin.required.replace(/^(.*?): .*$/, "at most $1")); // such as a wear depth
  const used = Math.min(100 * Number(margin.used ?? Infinity), FULL);
  const fill = el("i", { class: margin.used > 1 ? "over" : "under" });
  fill.style.width = `${(used / FULL) * 100}%`;
  const line = el("b", {});
  line.style.left = `${(100 / FULL) * 100}%`;
  return el("span", { class: "usage" }, el("span", { class: "bar", role: "img", "aria-label": `${margin.share} of the limit are used` }, fill, line), el("span", { class: "n" }, margin.share));
}

function margins(list, complete) {
  const head = el("tr", {}, ["limit", "of", "used", "margin", "life"].map((text) => el("th", { scope: "col" }, text)));
  const short = (title) => title.split(" (")[0]; // the remark in brackets stays where it tells two limits apart
  const alone = (title) => new Set(list.map((m) => m.title).filter((other) => short(other) === short(title))).size === 1;
  const body = list.map((m) =>
    el(
      "tr",
      { title: `${m.title}: now ${m.now}, at most ${m.required}; ${m.when}` },
      el("th", { scope: "row" }, symbol(alone(m.title) ? short(m.title) : m.title), m.guessed ? el("span", { class: "soft", title: "rests on placeholders of a material" }, " *") : null),
      el("td", {}, m.body.includes(" and ") ? "both" : m.body),
      el("td", {}, bar(m)),
      el("td", { class: "n" }, m.factor),
      el("td", { class: "n" }, m.beyond && Number.isFinite(m.hours) ? `${m.life.replace(BEYOND, "")} †` : m.life),
    ),
  );
  const guessed = list.some((m) => m.guessed) ? "* rests on placeholders. " : "";
  const beyond = list.some((m) => m.beyond && Number.isFinite(m.hours)) ? "† beyond the S-N data. " : "";
  return [
    el("table", { class: "margins" }, el("thead", {}, head), el("tbody", {}, body)),
    el("p", { class: "soft" }, guessed, beyond, "Margin: permitted over present load, at least 1.", complete ? "" : " The distances to slip and lift-off follow when it rests."),
  ];
}

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
    lives: section("Life", lives),
    inside,
    redraw: () => (fold(), draw()),
    show(picture, unworn) {
      if (last && picture.accuracy === "standard" && !picture.sections.length && inside()) picture.sections = last.sections;
      last = picture;
      verdict.textContent = picture.verdict;
      stage.textContent = `shown: ${SHOWN[picture.accuracy] ?? picture.accuracy}${unworn ? ", before the travel; wear follows at rest, after seconds" : ""}`;
      stage.dataset.stage = picture.complete ? "complete" : picture.accuracy;
      node.classList.toggle("preview", picture.accuracy === "preview");
      const said = [...picture.flags.map((flag) => [flag.sentence, flag.remedy]), ...picture.doubts.map((text) => ["Doubtful.", text])];
      replace(warnings, said.map(([head, text]) => el("li", { title: text }, el("strong", {}, head), " ", text)));
      replace(drawing, drawn(picture.drawing));
      replace(tables, picture.lines.length ? lines(picture.lines) : el("p", {}, picture.reason || "No values: a contact has lifted off."));
      replace(limits, margins(picture.margins, picture.complete));
      replace(lives, rows(picture.lives));
      replace(whole, whole.firstChild, rows(picture.whole));
      replace(unchecked, unchecked.firstChild, el("ul", {}, [...picture.not_checked, ...picture.guesses].map((text) => el("li", {}, text))));
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
