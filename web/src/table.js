// The table of the selected cases: only the rows in view exist as elements.
import { copy, download, el, replace } from "./dom.js";
import { heading, rawText, valueText, count } from "./words.js";

const ROW = 28; // height of a row in pixels
const VIEW = 336;
const SPARE = 6; // rows above and below the view

export function table(model) {
  const { table: study } = model;
  const columns = study.of("factor", "output", "design", "state").filter((c) => !c.name.startsWith("validity_"));
  const sort = { name: "", down: false };
  let rows = new Uint32Array(0);
  let focused = 0;

  const heads = columns.map((column) => {
    const button = el("button", { type: "button", onclick: () => by(column) }, heading(column));
    return { column, node: el("div", { role: "columnheader", "aria-sort": "none" }, button) };
  });
  const case_ = el("div", { role: "columnheader" }, "Case");
  const head = el("div", { role: "row", class: "row head", "aria-rowindex": "1" }, case_, heads.map((h) => h.node));
  const body = el("div", { role: "rowgroup", class: "rows" });
  const grid = el(
    "div",
    { role: "grid", class: "cases", tabindex: "0", "aria-label": "Selected cases", "aria-colcount": String(columns.length + 1) },
    el("div", { role: "rowgroup" }, head),
    body,
  );
  const copied = el("button", { type: "button", onclick: () => copy(text("\t", rows.slice(0, 5000)), copied) }, "Copy");
  const file = el("button", { type: "button", onclick: () => download(`${study.name}-selection.csv`, text(",", rows), "text/csv") }, "Export CSV");
  const said = el("span", { class: "facts" });
  const node = el("div", { class: "panel" }, el("div", { class: "tools" }, copied, file, said), grid);

  function text(separator, chosen) {
    const kept = study.of("factor", "input", "output", "design", "state");
    const number = (words) => !Number.isNaN(Number(words.replace("inf", "Infinity")));
    const runs = (words) => /^[=+\-@\t\r]/.test(words) && !number(words); // as a formula, in a spreadsheet
    const inert = (words) => (runs(words) ? `'${words}` : words);
    const quoted = (words) => (/[",\n\t]/.test(words) ? `"${inert(words).replaceAll('"', '""')}"` : inert(words));
    const lines = [["case", ...kept.map((c) => c.name)].map(quoted).join(separator)];
    for (const row of chosen) lines.push([String(study.caseOfRow(row)), ...kept.map((c) => rawText(c, row))].map(quoted).join(separator));
    return `${lines.join("\r\n")}\r\n`;
  }

  function by(column) {
    sort.down = sort.name === column.name ? !sort.down : false;
    sort.name = column.name;
    model.tell("sort");
  }

  function ordered() {
    rows = model.rows();
    const column = study.columns.get(sort.name);
    if (!column) return;
    const keys = column.codes ?? column.values;
    const sign = sort.down ? -1 : 1;
    const missing = (v) => Number.isNaN(v) || (column.codes !== undefined && v < 0);
    rows.sort((a, b) => {
      const [p, q] = [keys[a], keys[b]];
      if (missing(p) || missing(q)) return missing(p) - missing(q) || a - b; // rows without a value stand last
      return p === q ? a - b : p < q ? -sign : sign;
    });
  }

  function draw() {
    ordered();
    for (const { column, node: cell } of heads)
      cell.setAttribute("aria-sort", column.name !== sort.name ? "none" : sort.down ? "descending" : "ascending");
    grid.setAttribute("aria-rowcount", String(rows.length + 1));
    body.style.height = `${Math.max(1, rows.length) * ROW}px`;
    focused = Math.max(0, Math.min(focused, rows.length - 1));
    said.textContent = rows.length > 5000 ? `${count(rows.length)} rows; Copy takes the first 5,000.` : `${count(rows.length)} rows`;
    view();
  }

  function view() {
    const first = Math.max(0, Math.floor(grid.scrollTop / ROW) - SPARE);
    const last = Math.min(rows.length, Math.ceil((grid.scrollTop + VIEW) / ROW) + SPARE);
    const shown = [];
    for (let k = first; k < last; k++) shown.push(line(k));
    replace(body, shown.length ? shown : el("div", { role: "row", class: "row" }, el("div", { role: "gridcell" }, "No case is selected.")));
  }

  function line(k) {
    const row = rows[k];
    const cells = columns.map((c) => el("div", { role: "gridcell", class: c.codes ? "" : "n" }, valueText(c, row)));
    const number = el("div", { role: "rowheader" }, String(study.caseOfRow(row)));
    const classes = ["row", k === focused ? "focused" : "", model.pins.includes(row) ? "pinned" : "", k % 2 ? "odd" : ""];
    const node = el("div", { role: "row", class: classes.join(" "), "aria-rowindex": String(k + 2) }, number, cells);
    node.style.top = `${k * ROW}px`;
    if (model.pins.includes(row)) node.setAttribute("aria-selected", "true");
    node.addEventListener("click", () => ((focused = k), model.pin(row)));
    node.addEventListener("pointerenter", () => model.hover(row));
    return node;
  }

  grid.addEventListener("scroll", () => requestAnimationFrame(view));
  grid.addEventListener("pointerleave", () => model.hover(-1));
  grid.addEventListener("keydown", (event) => {
    if (event.target !== grid) return; // the heads are buttons of their own
    const steps = { ArrowDown: 1, ArrowUp: -1, PageDown: 10, PageUp: -10, Home: -Infinity, End: Infinity };
    if (event.key in steps) {
      focused = Math.max(0, Math.min(rows.length - 1, focused + steps[event.key]));
      const top = focused * ROW;
      if (top < grid.scrollTop) grid.scrollTop = top;
      if (top + 2 * ROW > grid.scrollTop + grid.clientHeight) grid.scrollTop = top + 2 * ROW - grid.clientHeight;
      model.hover(rows[focused] ?? -1);
      view();
    } else if (event.key === "Enter" || event.key === " ") {
      if (rows.length) model.pin(rows[focused]);
    } else return;
    event.preventDefault();
  });

  return {
    node,
    draw,
    view,
    sort,
    rows: () => rows,
    by,
  };
}
