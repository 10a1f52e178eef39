// A case in words: on touch its main figures, pinned all that its sheet says and the commands that repeat it.
import { copy, el, replace } from "./dom.js";
import { count, letter, number, withUnit } from "./words.js";

const IN_SHORT = ["roller_life_hours", "life_cycles_roller", "guide_life_hours", "life_cycles_guide", "peak_stress_roller", "peak_stress_guide", "max_pressure"];

// A word as the shell reads it, in quotes where it needs them.
export const quoted = (word) => (/^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replaceAll("'", `'"'"'`)}'`);

function plainNumber(value) {
  if (!Number.isFinite(value)) return value > 0 ? "inf" : "-inf";
  return Number.isInteger(value) && Math.abs(value) < 1e15 ? value.toFixed(1) : String(value);
}

export function solveCommand(study, row) {
  const words = ["trackroller", "solve"];
  for (const [key, told] of study.settings) {
    const column = Array.isArray(told) ? study.columns.get(told[0]) : null;
    let text = told;
    if (column?.codes && !column.number) text = column.codes[row] < 0 ? "" : column.levels[column.codes[row]];
    else if (column) text = Number.isNaN(column.values[row]) ? "" : plainNumber(column.values[row]);
    if (text !== "") words.push("--set", `${key}=${text}`);
  }
  return words.map(quoted).join(" ");
}

export const repeatCommand = (study, row) => `trackroller repeat ${quoted(study.name)} ${study.caseOfRow(row)}`;

function flags(study, row) {
  const told = [];
  const whole = study.columns.get("validity");
  if (!whole) return "";
  for (const body of ["roller", "guide"]) {
    const column = study.columns.get(`validity_${body}`);
    const text = column ? column.texts[column.codes[row]] : "none";
    if (text !== "none") told.push(...text.split("; ").map((t) => [t, body]));
  }
  const of = (text) => told.filter(([t]) => t === text).map(([, body]) => body);
  const text = whole.texts[whole.codes[row]];
  if (text === "none") return "none";
  return text.split("; ").map((t) => (of(t).length ? `${t} (${of(t).join(" and ")})` : t)).join("; ");
}

const material = (study, row, body) => {
  const told = study.settings.find(([key]) => key === `${body}_material`)?.[1];
  if (!Array.isArray(told)) return told;
  const column = study.columns.get(told[0]);
  return column.levels[column.codes[row]];
};

function utilisation(study, row) {
  const found = [];
  for (const body of ["roller", "guide"]) {
    const peak = study.columns.get(`peak_stress_${body}`)?.values[row];
    const known = study.strengths[material(study, row, body)];
    if (peak >= 0 && known) found.push([`Peak stress of the ${body} as a share of its fatigue limit`, `${number((100 * peak) / known[1], 3)} %`], [`Peak stress of the ${body} as a share of its tensile strength`, `${number((100 * peak) / known[0], 3)} %`]);
  }
  return found;
}

// How far a case is from lift-off: its least normal force, and in a grid the axial force at which the contact lifts.
function liftOff(study, row) {
  const loads = ["1", "2"].map((i) => (study.columns.get(`normal_force_${i}`) ?? study.columns.get(`normal_force[${i}]`))?.values[row] ?? NaN);
  const [least, most] = [Math.min(...loads), Math.max(...loads)];
  const found = least >= 0 ? [["Least normal force (0 at lift-off)", `${number(least, 3)} N, ${number((100 * least) / most, 3)} % of the other`]] : [];
  const axial = study.columns.get("axial_force");
  if (!study.grid || axial?.role !== "factor") return found;
  const others = study.of("factor").filter((c) => c !== axial);
  const lift = study.columns.get("regime").levels.indexOf("lift_off");
  const states = new Map();
  for (let i = 0; i < study.count; i++) if (others.every((c) => c.codes[i] === c.codes[row])) states.set(axial.values[i], study.columns.get("regime").codes[i] === lift);
  const forces = [...states.keys()].sort((a, b) => a - b);
  const first = forces.find((f) => f >= Math.max(0, axial.values[row]) && states.get(f));
  const last = forces.findLast((f) => (first === undefined || f < first) && !states.get(f));
  if (last === undefined) return found;
  const told = first === undefined ? `none up to ${number(last)} N` : `between ${number(last)} and ${number(first)} N`;
  return [...found, ["Lift-off by axial force, all else equal", told]];
}

// All that is known of a case: heads of sections, and pairs of words and value.
function facts(study, row) {
  const rows = (list) => list.map((c) => [c.label, withUnit(c, row)]);
  const states = ["regime", "state", "reason"].map((name) => study.columns.get(name)).filter(Boolean);
  const parts = [
    ["Inputs", rows(study.of("factor"))],
    ...(study.lists.design ? [["Design, over its conditions", rows(study.of("design"))]] : []),
    ["Results", [...rows(study.of("output")), ...utilisation(study, row), ...liftOff(study, row)]],
    ["Regime and validity", [...rows(states), ["Flags", flags(study, row)]]],
  ];
  const details = study.of("detail");
  for (const contact of ["1", "2"]) {
    const own = details.filter((c) => new RegExp(`\\[${contact}\\b`).test(c.name));
    if (own.length) parts.push([`Contact ${contact}`, rows(own).map(([words, value]) => [words.replace(/ \(\d,?(\w*)\)$/, (_, body) => (body ? `, ${body}` : "")), value])]);
  }
  const whole = details.filter((c) => !c.name.includes("["));
  if (whole.length) parts.push(["Whole roller", rows(whole)]);
  return parts;
}

export function hoverText(study, row) {
  const parts = [`Case ${study.caseOfRow(row)}`, ...study.of("factor").map((c) => `${c.label} ${withUnit(c, row)}`)];
  for (const name of IN_SHORT) if (study.columns.has(name)) parts.push(`${study.columns.get(name).label} ${withUnit(study.columns.get(name), row)}`);
  const told = flags(study, row);
  parts.push(`Regime: ${withUnit(study.columns.get("regime"), row)}`, ...(told && told !== "none" ? [`Flags: ${told}`] : ["No flags"]));
  return parts;
}

export function cards(model) {
  const { table: study } = model;
  const hint = "Point at a case to read it, click to pin it. Pinned cases stand side by side.";
  const hovered = el("p", { class: "hovered", role: "status", "aria-live": "polite" }, hint);
  const pinned = el("div", { class: "pinned" });
  const whole = el("input", { type: "checkbox", onchange: () => (draw(), whole.focus()) });

  function hover() {
    hovered.textContent = model.hovered < 0 ? hint : hoverText(study, model.hovered).join(" · ");
  }

  function command(words, text) {
    const button = el("button", { type: "button", "aria-label": `Copy: ${words}`, onclick: () => copy(text, button) }, "Copy");
    return el("div", { class: "command" }, el("span", {}, words), el("code", {}, text), button);
  }

  function draw() {
    if (!model.pins.length) return replace(pinned);
    const found = model.pins.map((row) => facts(study, row));
    const several = found.length > 1;
    const heads = model.pins.map((row, i) => {
      const away = el("button", { type: "button", "aria-label": `Unpin case ${study.caseOfRow(row)}`, onclick: () => model.pin(row) }, "Unpin");
      return el("th", { scope: "col" }, `${letter(i)}: case ${study.caseOfRow(row)} `, away);
    });
    const body = el("tbody");
    let [differences, all] = [0, 0];
    found[0].forEach(([head, rows], s) => {
      const lines = rows.flatMap(([words]) => {
        const values = found.map((f) => f[s][1].find(([other]) => other === words)?.[1] ?? "–");
        const apart = several && values.some((value) => value !== values[0]);
        differences += apart;
        all += 1;
        return apart || whole.checked || !several ? [el("tr", {}, el("th", { scope: "row" }, words), values.map((value) => el("td", {}, apart && whole.checked ? el("strong", {}, value) : value)))] : [];
      });
      if (lines.length) body.append(el("tr", { class: "part" }, el("th", { colspan: String(found.length + 1), scope: "colgroup" }, head)), ...lines);
    });
    const said = several ? `The ${count(found.length)} cases differ in ${count(differences)} of ${count(all)} rows, as they are rounded here.` : "Pin another case to compare.";
    const commands = model.pins.flatMap((row, i) => [
      command(`Solve ${letter(i)} again`, solveCommand(study, row)),
      command(`Compare ${letter(i)} with the stored result`, repeatCommand(study, row)),
    ]);
    replace(
      pinned,
      el("h3", {}, "Pinned cases"),
      el("p", { class: "tools" }, several ? el("label", {}, whole, " Rows without a difference too") : null, el("button", { type: "button", onclick: () => model.unpin() }, "Unpin all")),
      el("p", { class: "facts" }, `${said} With "--report sheet.html" behind it, a solve command writes the sheet of the case with its exact distances to lift-off, full slip and self-locking.`),
      el("div", { class: "wide", tabindex: "0", role: "region", "aria-label": "Pinned cases" }, el("table", {}, el("thead", {}, el("tr", {}, el("td", {}), heads)), body)),
      commands,
    );
  }

  return { hovered, pinned, hover, draw };
}
