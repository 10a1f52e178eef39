// The live page: tabs, the fields of the roller, and what follows from every change of them.
import { ask } from "./api.js";
import { carriageView } from "./carriage.js";
import { copy, el, replace } from "../dom.js";
import { parameterRow, wordRow } from "./fields.js";
import { live } from "./live.js";
import { materialsEditor } from "./materials.js";
import { pictureView } from "./picture.js";
import { requirementView } from "./requirement.js";
import { resultsView } from "./results.js";
import { createState } from "./state.js";
import { studyView } from "./study.js";
import { whatIf } from "./whatif.js";

const TABS = [
  ["roller", "Roller"],
  ["whatif", "What if"],
  ["study", "Study"],
  ["results", "Results"],
  ["carriage", "Carriage"],
  ["requirement", "Requirement"],
];
const OPEN = ["Loads and use", "Roller and guide"];
const INSTEAD = { axis_distance: ["outer_radius", "groove_depth"], outer_radius: ["axis_distance"], groove_depth: ["axis_distance"] };
const DRAWN = "Sizes of a drawing, duty";
const DUTY = ["hours_per_day", "days_per_year", "strokes_per_day", "stroke", "rollers_on_rail"]; // the sheet shows the first two
const DECIDED = ["outputs", "accuracy", "stop_if", "shortcuts"]; // options that the page sets itself

// The values of a material that have a unit.
const facts = (material = {}) => Object.entries(material).filter(([key]) => key.includes("[")).map((entry) => entry.join(" ")).join(", ");

async function start() {
  const root = document.querySelector("#app");
  const offered = await ask("all_fields");
  const state = createState();
  const rows = new Map();
  const times = []; // ms from the event of a slider to its picture
  let since = 0;
  let looked = false; // for studies that run; the server loads much for them, which would delay the first picture
  const seen = (ready) => ready && !looked && ((looked = true), results.look());

  const view = pictureView({ again: () => flow.again() });
  const flow = live({
    values: () => state.values,
    inside: () => view.inside() && state.tab === "roller",
    shown(picture, { unworn }) {
      seen(picture.complete);
      for (const row of rows.values()) row.complain("");
      view.show(picture, unworn);
      if (since) requestAnimationFrame(() => (times.push(performance.now() - since), (since = 0)));
    },
    failed(errors) {
      seen(true);
      for (const row of rows.values()) row.complain("");
      for (const { field, message } of errors) {
        const unknown = (name) => state.values[name] && !offered.materials.some((m) => m.name === state.values[name]);
        const [head] = field.split(/[., (]/); // of "roller_profile.file" and "axial_force, line 1"
        rows.get(head === "material" ? offered.bodies.find(unknown) : head === "duty" ? DUTY[0] : head)?.complain(message);
      }
      view.refuse(errors);
    },
  });
  const study = studyView(state, offered, { started: () => results.look() });
  const running = el("button", { type: "button", class: "running", hidden: true, onclick: () => state.show("results") });
  const results = resultsView(state, {
    open: (text) => study.open(text),
    told(list) {
      running.hidden = !list.length;
      running.textContent = list.map((s) => `${s.name}: ${s.total ? Math.round((100 * (s.done ?? 0)) / s.total) : 0} %`).join(", ");
    },
  });
  const variants = whatIf(state, offered, { rows });

  const fields = el("form", { class: "fields", "aria-label": "The roller", onsubmit: (event) => event.preventDefault() });
  const group = (title, ...content) => (OPEN.includes(title) ? el("fieldset", {}, el("legend", {}, title), content.flat()) : el("details", {}, el("summary", {}, title), content.flat()));
  const change = (name) => (value, moving = false) => {
    if (moving && !since) since = performance.now();
    const instead = value === null ? [] : (INSTEAD[name] ?? []);
    state.change({ ...Object.fromEntries(instead.map((other) => [other, null])), [name]: value }, moving);
  };
  const add = (name, row) => (rows.set(name, row), row.node);
  const grouped = Map.groupBy ? Map.groupBy(offered.parameters, (p) => p.group) : offered.parameters.reduce((m, p) => m.set(p.group, [...(m.get(p.group) ?? []), p]), new Map());
  const parameters = (title) => (grouped.get(title) ?? []).map((p) => add(p.name, parameterRow(p, { change: change(p.name), curve: () => variants.curve(p.name), factor: (range) => study.add(p.name, range) })));
  // a round rail has twice the radius of its contour as diameter; a unit behind the number stays
  const scaled = (value, k) => (value === null || value === undefined ? value : String(value).replace(/^[-+\d.eE]+/, (size) => String(Number(size) * k)));
  const contour = offered.parameters.find((p) => p.name === "guide_profile_radius");
  const rail = parameterRow(
    { ...contour, name: "rail_diameter", label: "Rail diameter", symbol: "", meaning: "of a round rail: twice the guide profile radius", value: 2 * contour.value, ends: contour.ends?.map((end) => 2 * end) ?? null },
    { change: (value, moving) => change(contour.name)(scaled(value, 0.5), moving), curve: () => variants.curve(contour.name), factor: (range) => study.add(contour.name, range?.map((end) => end / 2)) },
  );
  const dutyOf = (name) => String(state.values.duty ?? "").match(new RegExp(`(?:^|[{,\\s"])${name}"?:\\s*([^,}]+)`))?.[1].trim();
  const setDuty = (name) => (value) => {
    const given = Object.entries({ ...Object.fromEntries(DUTY.map((key) => [key, dutyOf(key)])), [name]: value }).filter(([, size]) => size !== undefined && size !== null);
    state.change({ duty: given.length ? `{${given.map((pair) => pair.join(": ")).join(", ")}}` : null });
  };
  const dutyRow = (name, label, unit, allowed) => add(name, parameterRow({ name, label, unit, allowed, symbol: "", meaning: `${label} of travel: lives in years, too`, value: null, ends: null, optional: true }, { change: setDuty(name) }));
  const duty = [dutyRow(DUTY[0], "Duty, hours a day", "h", "> 0, at most 24"), dutyRow(DUTY[1], "Duty, days a year", "", "> 0, at most 366; 365 if not given")];
  const shown = {
    rail_diameter: () => scaled(state.values[contour.name], 2),
    axis_distance: () => (INSTEAD.axis_distance.some((name) => state.values[name] !== undefined) ? "" : state.values.axis_distance),
    ...Object.fromEntries(DUTY.map((name) => [name, () => dutyOf(name)])),
  };
  const named = () => offered.materials.map((m) => el("option", { value: m.name, label: `${m.name}: ${m.family}, ${m.description}` }));
  const datalist = el("datalist", { id: "materials" }, named());
  const editor = materialsEditor(offered, {
    saved(materials) {
      offered.materials = materials;
      replace(datalist, named());
      variants.forget();
      flow.changed();
    },
  });
  const bodies = offered.bodies.map((name) => add(name, wordRow({ name, label: `${name.replace("_", " ")}`.replace(/^./, (c) => c.toUpperCase()), meaning: "a name of the database; type a part of it, or of its description", list: "materials", fallback: offered.materials[0].name }, { change: change(name), factor: () => study.add(name) })));
  const options = offered.options.filter((o) => !DECIDED.includes(o.name)).map((o) => add(o.name, wordRow({ name: o.name, label: o.name.replaceAll("_", " "), meaning: o.meaning, words: o.kind === "word" ? o.values : o.kind === "switch" ? { true: "", false: "" } : null, fallback: Array.isArray(o.value) ? "" : String(o.value) }, { change: change(o.name) })));
  const more = [...offered.mappings, { name: "sheet", meaning: "{project: Lift 7, part: R-12, revision: B, date: 2026-11-27, author: Ada, checker: Bo}: the head of the sheet" }].map((m) => add(m.name, wordRow({ name: m.name, label: m.name.replaceAll("_", " "), meaning: m.meaning, list: m.name.endsWith("_profile") ? "files" : null }, { change: change(m.name) })));
  const files = el("datalist", { id: "files" }, offered.files.map((file) => el("option", { value: `{file: ${JSON.stringify(file)}}`, label: file })));
  fields.append(
    group(OPEN[0], parameters(OPEN[0])),
    group(OPEN[1], parameters(OPEN[1]), bodies, datalist),
    group(DRAWN, add("rail_diameter", rail), parameters(DRAWN), duty),
    group("Limits: what they need", [...grouped.keys()].filter((title) => ![...OPEN, DRAWN].includes(title)).flatMap(parameters)),
    group("Materials, model and conventions", editor.node, options),
    group("Profiles, friction law, bearing, catalogue, head of the sheet", el("p", { class: "soft" }, "Written as in a case file. The fields of a profile offer the CSV files of this page's folder; a drawn profile needs normal: halfspace."), more, files),
  );

  const edited = () => (state.tab === "carriage" ? carriage : state); // whose changes are undone
  const undo = el("button", { type: "button", title: "Ctrl+Z", onclick: () => edited().undo() }, "Undo");
  const redo = el("button", { type: "button", title: "Ctrl+Y", onclick: () => edited().redo() }, "Redo");
  const steps = () => {
    undo.disabled = !edited().canUndo();
    redo.disabled = !edited().canRedo();
  };
  const carriage = carriageView(state, { changed: steps });
  const requirement = requirementView(state, offered, { duty: [["hours_per_day", "Hours a day", "of travel; or the strokes instead"], ["days_per_year", "Days a year", "of travel; 365 if not given"], ["strokes_per_day", "Strokes a day", "to and fro count two; in place of hours a day"], ["stroke", "Stroke [m]", "length of a stroke, such as 2 m"], ["rollers_on_rail", "Rollers that pass a point of the rail", "in a stroke; 1 if not given"]].map(([name, label, help]) => [name, label, help, () => dutyOf(name), setDuty(name)]) });
  const reset = el("button", { type: "button", onclick: () => state.replace(offered.first) }, "Reset");
  const pin = el("button", { type: "button", onclick: () => state.pin() }, "Pin");
  const sheet = el("a", { target: "_blank", rel: "noopener" }, "Printable sheet");
  const link = el("button", { type: "button", title: "without the address of this server", onclick: () => copy(location.href, link) }, "Copy link");
  const tabs = TABS.map(([name, text]) => el("button", { type: "button", role: "tab", id: `tab-${name}`, "aria-controls": `panel-${name}`, onclick: () => state.show(name) }, text));
  const contents = { roller: el("div", { class: "roller" }, fields, view.node, el("div", { class: "lives" }, view.lives)), whatif: variants.node, study: study.node, results: results.node, carriage: carriage.node, requirement: requirement.node };
  const panels = TABS.map(([name]) => el("div", { role: "tabpanel", id: `panel-${name}`, "aria-labelledby": `tab-${name}`, tabindex: "-1" }, contents[name]));
  const list = el("div", { role: "tablist", "aria-label": "Parts of the page" }, tabs);
  list.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    const next = TABS[(TABS.findIndex(([name]) => name === state.tab) + step + TABS.length) % TABS.length][0];
    state.show(next);
    document.querySelector(`#tab-${next}`).focus();
  });
  replace(root, el("header", {}, el("h1", {}, "trackroller"), list, running, el("div", { class: "tools" }, undo, redo, reset, pin, sheet, link)), el("main", {}, panels));
  document.addEventListener("keydown", (event) => {
    if (!(event.ctrlKey || event.metaKey) || /^(TEXTAREA|INPUT)$/.test(event.target.tagName) && event.target.type !== "range") return;
    if (event.key === "z") edited().undo();
    else if (event.key === "y") edited().redo();
    else return;
    event.preventDefault();
  });

  let own = "";
  let writing = 0;
  function address() {
    clearTimeout(writing);
    writing = setTimeout(() => {
      own = `#${state.written()}`;
      if (location.hash !== own) history.replaceState(null, "", own === "#" ? location.pathname : own);
    }, 150);
  }
  state.onChange((what) => {
    if (what === "case" || what === "moving") {
      for (const row of rows.values()) row.set(shown[row.name] ? shown[row.name]() : state.values[row.name]);
      for (const name of offered.bodies) rows.get(name).tell(facts(offered.materials.find((m) => m.name === (state.values[name] ?? offered.materials[0].name))));
      steps();
      sheet.href = state.file("sheet");
      flow.changed();
      requirement.draw();
    }
    if (what === "tab") {
      tabs.forEach((tab, i) => {
        tab.setAttribute("aria-selected", String(TABS[i][0] === state.tab));
        tab.tabIndex = TABS[i][0] === state.tab ? 0 : -1;
        panels[i].hidden = TABS[i][0] !== state.tab;
      });
      if (state.tab === "results") results.look();
      if (state.tab === "study") study.draw();
      if (state.tab === "roller") view.redraw();
      if (state.tab === "carriage") carriage.draw();
      if (state.tab === "requirement") requirement.look();
      for (const own of [reset, pin, sheet]) own.hidden = state.tab === "carriage"; // they belong to the one roller
      steps();
    }
    if (what !== "moving") variants.draw();
    address();
  });
  addEventListener("hashchange", () => location.hash !== own && state.read(location.hash));
  addEventListener("resize", () => (view.redraw(), variants.redraw(), carriage.redraw()));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => (view.redraw(), variants.redraw()));
  state.read(location.hash || new URLSearchParams(offered.first).toString());
  if (!TABS.some(([name]) => name === state.tab)) state.show("roller");
  window.trackroller = { state, times };
  root.dataset.ready = "";
}

start().catch((error) => {
  document.querySelector("#app").textContent = error.message;
});
