// The view in the address of the page, so that it can be sent.
import { brushOf } from "./model.js";
import { byLevels } from "./scales.js";
import { numberOf } from "./data.js";

const HEAD = "#explore&";
const VIEWS = ["x", "y", "colour", "histogram"];
const LISTS = ["axes", "flipped"];

export function written(model, parts) {
  const found = new URLSearchParams();
  for (const [name, brush] of model.brushes) {
    const column = model.table.columns.get(name);
    const told = byLevels(column) ? brush.map((code) => String(column.levels[code])) : brush.map((v) => (Number.isFinite(v) ? Number(v.toPrecision(9)) : null));
    found.set(`brush.${name}`, JSON.stringify(told));
  }
  for (const key of VIEWS) found.set(key, model.views[key]);
  for (const key of LISTS) found.set(key, JSON.stringify(model.views[key]));
  if (model.pins.length) found.set("pins", model.pins.map((row) => model.table.numberOfRow(row)).join(","));
  if (model.chosen) found.set("rows", [...model.chosen].map((row) => model.table.numberOfRow(row)).join(","));
  found.set("goals", JSON.stringify(parts.goals.state));
  found.set("slice", JSON.stringify([parts.slices.state.x, ...parts.slices.held]));
  if (parts.table.sort.name) found.set("sort", `${parts.table.sort.name}${parts.table.sort.down ? " down" : ""}`);
  return HEAD + found;
}

export const isOurs = (hash) => hash.startsWith(HEAD);

// Take over what an address says. Unknown names and wrong forms are left out: anybody can write an address.
export function read(hash, model, parts) {
  if (!isOurs(hash)) return false;
  const found = new URLSearchParams(hash.slice(HEAD.length));
  const { columns } = model.table;
  const told = (key) => {
    try {
      return JSON.parse(found.get(key));
    } catch {
      return null;
    }
  };
  for (const name of [...model.brushes.keys()]) model.change(name, null);
  for (const key of found.keys()) {
    const name = key.startsWith("brush.") ? key.slice(6) : "";
    const column = columns.get(name);
    if (!column || column.role === "detail") continue;
    const wanted = told(key);
    const brush = byLevels(column) && Array.isArray(wanted) ? columnLevels(column, wanted) : brushOf(column, wanted);
    if (brush) model.change(name, brush);
  }
  for (const key of VIEWS) if (columns.has(found.get(key))) model.views[key] = found.get(key);
  for (const key of LISTS) {
    const names = told(key);
    if (Array.isArray(names)) model.views[key] = [...new Set(names)].filter((name) => columns.has(name));
  }
  const rows = (key) => {
    const wanted = new Map((found.get(key) ?? "").split(",").filter(Boolean).map((number) => [Number(number), -1]));
    for (let i = 0; i < model.table.count; i++) if (wanted.has(model.table.numberOfRow(i))) wanted.set(model.table.numberOfRow(i), i);
    return [...wanted.values()].filter((row) => row >= 0);
  };
  model.pins = rows("pins");
  model.restrict(found.has("rows") ? rows("rows") : null);
  goalsFrom(told("goals"), parts.goals.state, columns);
  sliceFrom(told("slice"), parts.slices, columns);
  const [name, way] = (found.get("sort") ?? "").split(" ");
  if (columns.has(name)) Object.assign(parts.table.sort, { name, down: way === "down" });
  return true;
}

function columnLevels(column, wanted) {
  const kept = wanted.map((w) => column.levels.findIndex((level) => String(level) === String(w) || level === numberOf(w)));
  return [...new Set(kept)].filter((code) => code >= 0).sort((a, b) => a - b);
}

function goalsFrom(told, state, columns) {
  if (!told || !Array.isArray(told.goals)) return;
  state.goals = told.goals.filter((g) => Array.isArray(g) && columns.get(g[0])?.values && ["min", "max"].includes(g[1])).slice(0, 3);
}

function sliceFrom(told, slices, columns) {
  if (!Array.isArray(told)) return;
  const [x, ...held] = told;
  if (columns.get(x)?.role === "factor") slices.state.x = x;
  for (const entry of held) {
    if (!Array.isArray(entry)) continue;
    const column = columns.get(entry[0]);
    if (slices.held.has(entry[0]) && column.codes && Number.isInteger(entry[1]) && entry[1] >= 0 && entry[1] < column.levels.length) slices.held.set(entry[0], entry[1]);
  }
}
