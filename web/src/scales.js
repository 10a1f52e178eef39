// The axis of a column: positions from 0 to 1, ticks and what a piece of the axis selects.
import { scaleLinear, scaleLog } from "d3-scale";
import { number, tick } from "./words.js";

const MOST_LEVELS = 12; // more levels of a number make an axis of numbers

export const byLevels = (column) => Boolean(column.codes) && (!column.number || column.role === "design" || column.levels.length <= MOST_LEVELS);

export function bounds(values) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (value < low && value > -Infinity) low = value;
    if (value > high && value < Infinity) high = value;
  }
  return low <= high ? [low, high] : [NaN, NaN];
}

// Numbers lie in proportion to their values unless two of them would touch; names lie in even steps.
// A state that no case has needs no place.
function levelPlaces(column) {
  if (column.role === "state") {
    const there = column.levels.map((_, i) => i).filter((i) => column.codes.includes(i));
    return column.levels.map((_, i) => (there.includes(i) ? (there.indexOf(i) + 0.5) / there.length : NaN));
  }
  const n = Math.max(1, column.levels.length);
  const even = column.levels.map((_, i) => (i + 0.5) / n);
  if (!column.number || n < 3 || !column.levels.every(Number.isFinite)) return even;
  const [low, high] = bounds(column.levels);
  const places = column.levels.map((value) => 0.5 / n + ((value - low) / (high - low)) * (1 - 1 / n));
  const sorted = [...places].sort((a, b) => a - b);
  return sorted.every((place, i) => !i || place - sorted[i - 1] >= 0.4 / n) ? places : even;
}

function levelScale(column) {
  const places = levelPlaces(column);
  const place = (code) => (code < 0 ? NaN : places[code]);
  return {
    levels: true,
    unit: (code) => place(code),
    ofRow: (row) => place(column.codes[row]),
    ticks: column.texts.map((text, i) => [place(i), text]).filter(([at]) => !Number.isNaN(at)),
    piece: (from, to) => column.levels.map((_, i) => i).filter((i) => place(i) >= from && place(i) <= to),
  };
}

function numberScale(...columns) {
  const [column] = columns;
  const ends = columns.map((c) => bounds(c.values)).filter(([low]) => !Number.isNaN(low));
  let [low, high] = ends.length ? [Math.min(...ends.map((e) => e[0])), Math.max(...ends.map((e) => e[1]))] : [NaN, NaN];
  const known = !Number.isNaN(low);
  if (!known) [low, high] = [0, 1];
  const log = column.log && low > 0;
  if (low === high) [low, high] = log ? [low / 2, high * 2] : [low - (Math.abs(low) || 1) / 2, high + (Math.abs(high) || 1) / 2];
  const scale = (log ? scaleLog() : scaleLinear()).domain([low, high]).nice();
  scale.range([0, 1]);
  const [first, last] = scale.domain();
  const unit = (value) => {
    if (value === Infinity) return 1.06; // unlimited: above the axis
    if (value === -Infinity || Number.isNaN(value)) return NaN;
    return log && value <= 0 ? NaN : scale(value);
  };
  const decades = log ? Math.log10(last / first) : 0;
  let ticks = scale.ticks(5);
  if (log) {
    const step = Math.max(1, Math.ceil(decades / 6));
    const start = Math.ceil(Math.log10(first) / step - 1e-9) * step;
    const whole = [];
    for (let power = start; power <= Math.log10(last) + 1e-9; power += step) whole.push(10 ** power);
    ticks = whole.length > 1 ? whole : ticks.filter((_, i) => i % Math.ceil(ticks.length / 5) === 0);
  }
  return {
    levels: false,
    log,
    known,
    low: number(first, 3),
    high: number(last, 3),
    unit,
    ofRow: (row) => unit(column.values[row]),
    value: (place) => scale.invert(place),
    ticks: known ? ticks.map((t) => [scale(t), tick(t)]) : [],
    piece: (from, to) => [from <= 0 ? -Infinity : scale.invert(from), to >= 1 ? Infinity : scale.invert(to)],
  };
}

const made = new WeakMap();
const placed = new WeakMap();
const orders = new WeakMap();

// Place of every case on the axis of a column, from 0 to 1.
export function placesOf(column) {
  if (!placed.has(column)) {
    const scale = scaleOf(column);
    const n = (column.codes ?? column.values).length;
    const places = new Float32Array(n);
    for (let i = 0; i < n; i++) places[i] = scale.ofRow(i);
    placed.set(column, places);
  }
  return placed.get(column);
}

// All cases in the order of their places; those without a value are left out.
export function ordered(column) {
  if (!orders.has(column)) {
    const places = placesOf(column);
    const rows = Uint32Array.from(places.keys()).filter((row) => !Number.isNaN(places[row]));
    orders.set(column, rows.sort((a, b) => places[a] - places[b]));
  }
  return orders.get(column);
}

export function scaleOf(column) {
  if (!made.has(column)) made.set(column, byLevels(column) ? levelScale(column) : numberScale(column));
  return made.get(column);
}

// One axis for several outputs of the same unit.
export const commonScale = (columns) => numberScale(...columns);
