// Columns of the study: decompress the block that Python packed and give each column its numbers.
import { unzlibSync } from "fflate";

const ARRAYS = { u1: Uint8Array, u2: Uint16Array, u4: Uint32Array, f4: Float32Array, f8: Float64Array };

function bytesOf(base64) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(base64);
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return bytes;
}

async function inflate(bytes) {
  if (typeof DecompressionStream === "undefined") return unzlibSync(bytes);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Each column is stored byte by byte: all first bytes, then all second bytes, and so on.
function unshuffled(block, entry, rows) {
  const width = Number(entry.type[1]);
  const bytes = new Uint8Array(rows * width);
  for (let k = 0; k < width; k++) {
    const from = entry.start + k * rows;
    for (let i = 0, to = k; i < rows; i++, to += width) bytes[to] = block[from + i];
  }
  return new ARRAYS[entry.type](bytes.buffer);
}

export const numberOf = (level) => (level === "inf" ? Infinity : level === "-inf" ? -Infinity : level);

function column(entry, block, rows) {
  const stored = unshuffled(block, entry, rows);
  if (!entry.levels) return { ...entry, number: true, values: stored };
  const codes = Int32Array.from(stored, (code) => code - 1);
  const levels = entry.number ? entry.levels.map(numberOf) : entry.levels;
  const values = entry.number ? Float64Array.from(codes, (c) => (c < 0 ? NaN : levels[c])) : null;
  return { ...entry, levels, codes, values };
}

export async function load(header, base64) {
  const block = await inflate(bytesOf(base64));
  const columns = new Map(header.columns.map((entry) => [entry.name, column(entry, block, header.rows)]));
  for (const { name, codes, texts } of columns.values()) if (name.endsWith(":beyond")) columns.get(name.split(":")[0]).remark = (row) => texts[codes[row]];
  const told = (name) => columns.get(name)?.values;
  return {
    ...header,
    columns,
    count: header.rows,
    numberOfRow: (i) => (told("row") ? told("row")[i] : i),
    caseOfRow: (i) => (told("case") ?? told("row") ? (told("case") ?? told("row"))[i] : i),
    of: (...roles) => [...columns.values()].filter((c) => roles.includes(c.role)),
  };
}
