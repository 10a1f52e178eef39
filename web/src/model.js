// What is selected: brushes of the columns, counts, pinned cases, and who has to be told of a change.
import { byLevels } from "./scales.js";

export class Model {
  constructor(table) {
    this.table = table;
    this.brushes = new Map(); // name -> [low, high] of numbers, or positions of levels
    this.misses = new Uint8Array(table.count); // number of brushes that exclude a row
    this.count = table.count;
    this.state = table.columns.get("state").codes;
    this.pins = [];
    this.hovered = -1;
    this.marked = null; // rows of the Pareto set
    this.chosen = null; // rows that alone may be selected
    this.views = { x: "", y: "", colour: "state", histogram: "", axes: [], flipped: [] };
    this.shuffled = shuffle(table.count);
    this.listeners = [];
  }

  listen(listener) {
    this.listeners.push(listener);
  }

  tell(what) {
    for (const listener of this.listeners) listener(what);
  }

  // The rows that a brush excludes, as a test of one row.
  outside(name, brush) {
    const column = this.table.columns.get(name);
    if (byLevels(column)) {
      const allowed = new Uint8Array(column.levels.length + 1);
      for (const code of brush) allowed[code + 1] = 1;
      return (row) => !allowed[column.codes[row] + 1];
    }
    const [low, high] = brush;
    return (row) => !(column.values[row] >= low && column.values[row] <= high);
  }

  change(name, brush) {
    const before = this.brushes.has(name) ? this.outside(name, this.brushes.get(name)) : null;
    const after = brush ? this.outside(name, brush) : null;
    const { misses } = this;
    for (let i = 0; i < misses.length; i++) misses[i] += (after?.(i) ?? false) - (before?.(i) ?? false);
    if (brush) this.brushes.set(name, brush);
    else this.brushes.delete(name);
  }

  brush(name, brush) {
    this.change(name, brush);
    this.counted();
  }

  clear() {
    for (const name of [...this.brushes.keys()]) this.change(name, null);
    this.restrict(null);
    this.counted();
  }

  // Leave out every row but these; with null, no row is left out.
  restrict(rows) {
    const add = (step) => {
      const inside = new Set(this.chosen);
      for (let i = 0; i < this.misses.length; i++) if (!inside.has(i)) this.misses[i] += step;
    };
    if (this.chosen) add(-1);
    this.chosen = rows;
    if (this.chosen) add(1);
  }

  only(rows) {
    this.restrict(rows);
    this.counted();
  }

  counted() {
    let selected = 0;
    this.byState = new Array(this.table.states.length).fill(0);
    for (let i = 0; i < this.misses.length; i++) {
      if (this.misses[i]) continue;
      selected += 1;
      this.byState[this.state[i]] += 1;
    }
    this.count = selected;
    this.tell("selection");
  }

  rows() {
    const rows = new Uint32Array(this.count);
    for (let i = 0, k = 0; i < this.misses.length; i++) if (!this.misses[i]) rows[k++] = i;
    return rows;
  }

  pin(row) {
    this.pins = this.pins.includes(row) ? this.pins.filter((r) => r !== row) : [...this.pins, row];
    this.tell("pins");
  }

  unpin() {
    this.pins = [];
    this.tell("pins");
  }

  hover(row) {
    if (row === this.hovered) return;
    this.hovered = row;
    this.tell("hover");
  }

  mark(rows) {
    this.marked = rows;
    this.tell("marked");
  }

  view(key, value) {
    this.views[key] = value;
    this.tell("view");
  }
}

// A fixed order in which every part of the study comes early.
function shuffle(n) {
  const order = Uint32Array.from({ length: n }, (_, i) => i);
  let seed = 12345;
  for (let i = n - 1; i > 0; i--) {
    seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0;
    const j = seed % (i + 1);
    [order[i], order[j]] = [order[j], order[i]];
  }
  return order;
}

// A brush from what a script or the address of the page says: [low, high], a list of levels, or null.
export function brushOf(column, wanted) {
  if (!Array.isArray(wanted)) return null;
  const [low, high] = [wanted[0] ?? -Infinity, wanted[1] ?? Infinity];
  const range = wanted.length === 2 && typeof low === "number" && typeof high === "number" && column.number;
  if (!byLevels(column)) return range ? [low, high] : null;
  return column.levels
    .map((_, i) => i)
    .filter((i) => {
      if (range) return column.levels[i] >= low && column.levels[i] <= high;
      return wanted.some((w) => w === column.levels[i] || w === column.texts[i]);
    });
}
