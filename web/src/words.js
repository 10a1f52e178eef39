// Numbers and values as the report writes them.
const RAISED = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };

export const count = (n) => n.toLocaleString("en-US");

// The letter of a pinned case: A to Z, then AA, AB and so on.
export const letter = (i) => (i < 26 ? String.fromCharCode(65 + i) : letter(Math.floor(i / 26) - 1) + letter(i % 26));

export function number(value, figures = 4) {
  if (Number.isNaN(value)) return "–";
  if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
  const size = Math.abs(value);
  if (size >= 1e7 || (size > 0 && size < 1e-3)) {
    const [mantissa, exponent] = value.toExponential(Math.min(2, figures - 1)).split("e");
    const raised = [...String(Number(exponent))].map((c) => RAISED[c]).join("");
    return `${Number(mantissa)}·10${raised}`.replace("-", "−");
  }
  if (size >= 1e4) return Number(value.toPrecision(3)).toLocaleString("en-US").replace("-", "−");
  return String(Number(value.toPrecision(figures))).replace("-", "−");
}

// A tick of an axis: powers of ten from 100,000 on stay short.
export function tick(value) {
  const power = Math.log10(Math.abs(value));
  if (value > 0 && power > 4.5 && Math.abs(power - Math.round(power)) < 1e-9) return `10${[...String(Math.round(power))].map((c) => RAISED[c]).join("")}`;
  return number(value, 3);
}

export const isLife = (column) => column.name.includes("life");

// A life beyond the S-N data never stands alone; one without end is no number of hours.
export function valueText(column, row, unit = "") {
  const value = column.values?.[row];
  const endless = value === Infinity && isLife(column);
  let text = endless ? "no failure" : column.codes ? (column.texts[column.codes[row]] ?? "–") : number(value);
  if (unit && text !== "–" && !endless) text += ` ${unit}`;
  const remark = column.remark?.(row);
  return remark ? `${text} (${remark})` : text;
}

export const unitOf = (column) => (column.unit && column.unit !== "–" ? column.unit : "");

export const heading = (column) => (unitOf(column) ? `${column.label} [${column.unit}]` : column.label);

export const withUnit = (column, row) => valueText(column, row, unitOf(column));

// The full value, for files: numbers with every digit, levels by their own name.
export function rawText(column, row) {
  if (column.codes && !column.number) return column.codes[row] < 0 ? "" : String(column.levels[column.codes[row]]);
  const value = column.values[row];
  if (Number.isNaN(value)) return "";
  return Number.isFinite(value) ? String(value) : value > 0 ? "inf" : "-inf";
}
