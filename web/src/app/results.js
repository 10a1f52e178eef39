// The studies of the folder: state, pages, pause and resume, comparison of two, and deletion after a question.
import { ask } from "./api.js";
import { el, replace } from "../dom.js";
import { count } from "../words.js";

const TICK = 1500; // ms between two looks at running studies
const size = (bytes) => (bytes < 1e6 ? `${Math.ceil(bytes / 1e3)} kB` : `${(bytes / 1e6).toFixed(1)} MB`);

export function resultsView(state, { open, told }) {
  const table = el("div", { class: "wide", tabindex: "0", role: "region", "aria-label": "Studies of this folder" });
  const own = el("p", { class: "tools" });
  const said = el("p", { role: "status" });
  const beside = el("div", { class: "beside" });
  const chosen = new Set();
  let list = [];
  let timer = 0;

  async function act(name, body) {
    try {
      await ask(name, body);
      said.textContent = "";
    } catch (error) {
      said.textContent = error.message;
    }
    look();
  }

  async function look() {
    clearTimeout(timer);
    try {
      list = await ask("listing");
    } catch (error) {
      said.textContent = error.message;
    }
    draw();
    told(list.filter((s) => s.state === "running"));
    if (state.tab === "results" || list.some((s) => s.state === "running")) timer = setTimeout(look, TICK);
  }

  function line(study) {
    const share = study.total ? Math.round((100 * (study.done ?? 0)) / study.total) : 0;
    const button = (label, action, of = "") => el("button", { type: "button", class: "mini", "aria-label": `${label} ${of}${study.name}`, onclick: action }, label);
    const link = (page, label) => el("a", { href: `results/${encodeURIComponent(study.name)}/${page}`, target: "_blank", rel: "noopener", "aria-label": `${label} of ${study.name}` }, label);
    const box = el("input", { type: "checkbox", "aria-label": `Compare ${study.name}`, checked: chosen.has(study.name), onchange: () => choose(study.name, box.checked) });
    const state_ = study.state === "running" ? [el("progress", { max: 100, value: share, "aria-label": `${study.name}: ${share} % solved` }), ` ${study.step}`] : [study.error ? `stopped: ${study.error}` : study.state];
    const done = study.state === "done";
    return el(
      "tr",
      {},
      el("td", {}, done ? box : null),
      el("th", { scope: "row" }, study.name),
      el("td", {}, study.question),
      el("td", {}, state_),
      el("td", { class: "n" }, study.total ? `${count(study.done ?? 0)} of ${count(study.total)}${study.failed ? `, ${count(study.failed)} failed` : ""}` : ""),
      el("td", { class: "n" }, size(study.bytes)),
      el("td", {}, study.date),
      el(
        "td",
        { class: "actions" },
        study.pages.includes("report.html") ? link("report.html", "Report") : null,
        study.pages.includes("report.html") ? el("a", { href: `results/${encodeURIComponent(study.name)}/report.html`, download: `${study.name}.html`, title: "one file, which can be sent", "aria-label": `Save the report of ${study.name}` }, "Save") : null,
        study.pages.includes("report.html") ? link("report.pdf", "PDF") : null,
        done ? link("cases.xlsx", "Workbook") : null,
        study.pages.includes("explorer.html") ? link("explorer.html", "Explorer") : null,
        done && study.pages.length < 2 ? button("Make the pages", () => act("resume", { name: study.name }), "of ") : null,
        study.state === "running" ? button("Pause", () => act("pause", { name: study.name })) : null,
        ["paused", "stopped"].includes(study.state) ? button("Resume", () => act("resume", { name: study.name })) : null,
        button("Edit", async () => open((await ask("text_of", { name: study.name })).text)),
        study.state !== "running" ? button("Delete", () => question(study)) : null,
      ),
    );
  }

  const files = [["sheet", "Sheet"], ["sheet.pdf", "Sheet as PDF"], ["roller.xlsx", "Workbook"]];
  state.onChange((what) => {
    if (what === "case") replace(own, files.map(([name, label]) => el("a", { href: state.file(name), target: "_blank", rel: "noopener" }, label)));
  });

  function draw() {
    const focus = document.activeElement?.getAttribute("aria-label");
    const heads = ["", "study", "question", "state", "cases", "size", "date", ""].map((text) => el("th", { scope: "col" }, text || el("span", { class: "hidden" }, "actions")));
    const body = list.length ? list.map(line) : [el("tr", {}, el("td", { colSpan: 8 }, "No study yet. The tab Study starts one."))];
    replace(table, el("table", { class: "studies" }, el("thead", {}, el("tr", {}, heads)), el("tbody", {}, body)));
    if (focus && document.activeElement === document.body) table.querySelector(`[aria-label="${CSS.escape(focus)}"]`)?.focus();
  }

  function choose(name, wanted) {
    wanted ? chosen.add(name) : chosen.delete(name);
    if (chosen.size > 2) chosen.delete([...chosen][0]);
    draw();
    compare();
  }

  async function compare() {
    if (!chosen.size) return replace(beside);
    replace(beside, el("p", {}, "Reading the results …"));
    try {
      const found = await Promise.all([...chosen].map((name) => ask("headlines", { name }, name)));
      const rows = (part, text) => {
        const keys = [...new Set(found.flatMap((one) => Object.keys(one[part])))];
        return keys.map((key) => {
          const cells = found.map((one) => (one[part][key] ? text(one[part][key]) : "–"));
          return el("tr", { class: new Set(cells).size > 1 ? "differs" : "" }, el("th", { scope: "row" }, key), cells.map((cell, i) => el("td", { class: i && cell !== cells[0] ? "other" : "" }, cell)));
        });
      };
      const part = (title, lines) => [el("tr", { class: "group" }, el("th", { scope: "colgroup", colSpan: found.length + 1 }, title)), lines];
      const short = found.map((one) => ({ short: Object.fromEntries(one.short) }));
      found.forEach((one, i) => (one.short = short[i].short));
      const head = el("tr", {}, el("th", { scope: "col" }, "study"), found.map((one) => el("th", { scope: "col" }, `${one.name} (${count(one.cases)} cases)`)));
      const body = [part("Factors", rows("factors", String)), part("Lowest … middle … highest, of the cases that roll", rows("numbers", (ends) => ends.join(" … "))), part("What it says", rows("short", String))];
      replace(beside, el("h2", {}, chosen.size > 1 ? "Two studies side by side" : "One study; choose a second one to compare"), el("table", { class: "variants" }, el("thead", {}, head), el("tbody", {}, body.flat(2))));
    } catch (error) {
      replace(beside, el("p", {}, error.message));
    }
  }

  function question(study) {
    const dialog = el(
      "dialog",
      { "aria-labelledby": "delete-question" },
      el("p", { id: "delete-question" }, `Delete the results of '${study.name}' (${size(study.bytes)})? Its study file stays.`),
      el("div", { class: "tools" }, el("button", { type: "button", onclick: () => dialog.close() }, "Keep"), el("button", { type: "button", class: "danger", onclick: () => (dialog.close(), chosen.delete(study.name), compare(), act("delete", { name: study.name, confirm: study.name })) }, "Delete")),
    );
    dialog.addEventListener("close", () => dialog.remove());
    document.body.append(dialog);
    dialog.showModal();
  }

  return { node: el("div", { class: "results" }, el("section", {}, el("h2", {}, "The roller on the screen"), own, el("h2", {}, "Studies of this folder"), said, table), beside), look };
}
