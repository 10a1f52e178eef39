// The Pareto set within limits, as `pareto` of the package finds it.
import { brushOf } from "./model.js";

const COMPARE = {
  "<": (a, b) => a < b,
  "<=": (a, b) => a <= b,
  ">": (a, b) => a > b,
  ">=": (a, b) => a >= b,
  "==": (a, b) => a === b,
  "!=": (a, b) => !Number.isNaN(a) && a !== b,
};

function found(table, name) {
  const column = table.columns.get(name);
  if (!column || (!column.values && !column.codes)) throw new RangeError(`there is no column '${name}'`);
  return column;
}

// A limit in words, such as "max_pressure < 1200" or "regime != full_slip", as a test of one row.
function compared(table, text) {
  const parts = /^\s*(.+?)\s*(<=|>=|==|!=|<|>)\s*(\S+)\s*$/.exec(text);
  if (!parts) throw new RangeError(`'${text}' is no comparison of a column with a value`);
  const [, name, sign, limit] = parts;
  const column = found(table, name);
  if (column.number) return (row) => COMPARE[sign](column.values[row], limit === "inf" ? Infinity : Number(limit));
  const code = column.levels.indexOf(limit.replace(/^(["'])(.*)\1$/, "$2"));
  return (row) => COMPARE[sign](column.codes[row], code);
}

// {name: [low, high]}, {name: {min, max}}, {name: [levels]} or a list of comparisons, as tests of one row.
function tests(table, limits) {
  if (Array.isArray(limits)) return limits.map((text) => compared(table, text));
  return Object.entries(limits ?? {}).map(([name, wanted]) => {
    const column = found(table, name);
    const list = Array.isArray(wanted) ? wanted : [wanted.min ?? null, wanted.max ?? null];
    if (column.number) {
      const [low, high] = [list[0] ?? -Infinity, list[1] ?? Infinity];
      return (row) => column.values[row] >= low && column.values[row] <= high;
    }
    const allowed = new Set(brushOf(column, list));
    return (row) => allowed.has(column.codes[row]);
  });
}

// The rolling cases alone are candidates, unless a limit or a constraint of the study names a regime.
function namesRegime(table, limits) {
  const speaks = (texts) => texts.some((text) => /\bregime\b/.test(text));
  if (Array.isArray(limits)) return speaks(limits);
  return Object.hasOwn(limits ?? {}, "regime") || (Object.hasOwn(limits ?? {}, "constraints") && speaks(table.constraints));
}

export function paretoRows(table, goals, limits, inside = () => true) {
  const sides = Object.entries(goals);
  if (sides.length < 2) throw new RangeError("a Pareto set needs at least two goals");
  const costs = sides.map(([name, way]) => {
    if (way !== "min" && way !== "max") throw new RangeError(`'${name}' is to be min or max, not '${way}'`);
    const { values } = found(table, name);
    if (!values) throw new RangeError(`'${name}' has names, which have no order`);
    return way === "min" ? values : Float64Array.from(values, (v) => -v);
  });
  const regime = table.columns.get("regime").codes;
  const last = namesRegime(table, limits) ? 2 : 0; // rolling, full slip, lift-off
  const checks = tests(table, limits);
  if (table.compared) {
    const models = table.columns.get("contact_model");
    const best = models.levels.indexOf(table.compared);
    checks.push((row) => models.codes[row] === best);
  }
  const rows = [];
  for (let i = 0; i < table.count; i++) {
    if (inside(i) && regime[i] <= last && !costs.some((cost) => Number.isNaN(cost[i])) && checks.every((test) => test(i))) rows.push(i);
  }
  return frontOf(costs, rows);
}

// The rows that no other beats in every cost, in rising order.
function frontOf(costs, candidates) {
  // in lexicographic order only an earlier row can beat a row
  const order = (a, b) => {
    for (const cost of costs) if (cost[a] !== cost[b]) return cost[a] - cost[b];
    return a - b;
  };
  const rows = Uint32Array.from(candidates).sort(order);
  const front = [];
  const beats = (a, b) => costs.every((cost) => cost[a] <= cost[b]) && costs.some((cost) => cost[a] < cost[b]);
  for (const row of rows) if (!front.some((other) => beats(other, row))) front.push(row);
  return front.sort((a, b) => a - b);
}
