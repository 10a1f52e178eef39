// Colours that keep apart in greyscale and for every kind of colour vision, and a shape for each state. Levels of a factor
// have the colours of the figures.
const STATES = {
  light: ["#0b5a8f", "#6b7177", "#b87400", "#c03a00", "#111111", "#9a3f7e", "#00785a"],
  dark: ["#7cc0ee", "#9aa2aa", "#f0b03c", "#ff8a5c", "#f4f4f4", "#e39ac8", "#4fc9a4"],
};
// cividis (Nuñez, Anderton and Renslow 2018), read at eight places
export const CIVIDIS = ["#00224e", "#123570", "#3b496c", "#575d6d", "#797877", "#a59c74", "#d3c164", "#fee838"];

export const SHAPES = ["disc", "ring", "triangle", "square", "cross", "diamond", "plus"];

export const isDark = () => matchMedia("(prefers-color-scheme: dark)").matches;

export function theme() {
  const style = getComputedStyle(document.documentElement);
  const read = (name) => style.getPropertyValue(name).trim();
  return { paper: read("--paper"), ink: read("--ink"), soft: read("--soft"), line: read("--line"), mark: read("--mark") };
}

export const parsed = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));

export function mixed(low, high, share) {
  const [a, b] = [parsed(low), parsed(high)];
  return `#${a.map((v, i) => Math.round(v + (b[i] - v) * share).toString(16).padStart(2, "0")).join("")}`;
}

function sequence() {
  // the end that equals the paper is left out: yellow on white, dark blue on black
  const [from, to] = isDark() ? [0.3, 1] : [0, 0.86];
  return Array.from({ length: 24 }, (_, i) => {
    const at = (from + ((to - from) * i) / 23) * (CIVIDIS.length - 1);
    const k = Math.min(Math.floor(at), CIVIDIS.length - 2);
    return mixed(CIVIDIS[k], CIVIDIS[k + 1], at - k);
  });
}

// Colours by a column: an index into `list` for each row, and entries for the legend.
export function colouring(column, scale, rows) {
  const index = new Uint8Array(rows);
  if (column.codes && (!column.number || column.levels.length <= 8)) {
    const list = column.colours ?? STATES[isDark() ? "dark" : "light"];
    for (let i = 0; i < rows; i++) index[i] = column.codes[i] < 0 ? list.length : column.codes[i] % list.length;
    const legend = column.texts.map((text, i) => [list[i % list.length], text]);
    return { list: [...list, "#888888"], index, legend };
  }
  const list = sequence();
  for (let i = 0; i < rows; i++) {
    const at = scale.ofRow(i);
    index[i] = Number.isNaN(at) ? list.length : Math.round(Math.max(0, Math.min(1, at)) * (list.length - 1));
  }
  const ends = scale.levels ? [column.texts[0], column.texts.at(-1)] : [scale.low, scale.high];
  return { list: [...list, "#888888"], index, ramp: ends };
}

export const packed = (hex) => {
  const [r, g, b] = parsed(hex);
  return (255 << 24) | (b << 16) | (g << 8) | r;
};
