// A pair of axes on a canvas, for scatter, histogram and curves.
import { canvas } from "./dom.js";
import { theme } from "./colours.js";

export const MARGIN = { left: 64, right: 14, top: 12, bottom: 44 };
const NONE = 16; // strip of the points without a value

export function plot(height, label) {
  const base = canvas(height, label);
  const { context, size } = base;
  const inner = () => [size.width - MARGIN.left - MARGIN.right, height - MARGIN.top - MARGIN.bottom];
  const x = (place) => MARGIN.left + (Number.isNaN(place) ? 0 : NONE + place * (inner()[0] - 2 * NONE));
  const y = (place) => height - MARGIN.bottom - (Number.isNaN(place) ? 0 : NONE + place * (inner()[1] - 2 * NONE));

  function clear() {
    context.clearRect(0, 0, size.width, height);
  }

  function frame(scaleX, scaleY, labelX, labelY) {
    const { ink, soft, line } = theme();
    const [width, tall] = inner();
    const bottom = height - MARGIN.bottom;
    context.strokeStyle = soft;
    context.lineWidth = 1;
    context.setLineDash([]);
    context.strokeRect(MARGIN.left + 0.5, MARGIN.top + 0.5, width, tall);
    context.font = "11px system-ui, sans-serif";
    context.fillStyle = ink;
    context.textAlign = "center";
    const room = Math.max(2, Math.floor(width / 58));
    for (const [at, words] of thinned(scaleX.ticks, room)) {
      context.fillRect(x(at), bottom, 1, 4);
      context.fillText(cut(words, scaleX.levels ? Math.max(6, Math.floor(width / Math.min(room, scaleX.ticks.length) / 6)) : 12), x(at), bottom + 15);
    }
    context.fillText(cut(labelX, Math.floor(size.width / 6.5)), MARGIN.left + width / 2, height - 8);
    context.textAlign = "right";
    for (const [at, words] of thinned(scaleY.ticks, Math.floor(tall / 22))) {
      context.strokeStyle = line;
      context.beginPath();
      context.moveTo(MARGIN.left, y(at));
      context.lineTo(MARGIN.left + width, y(at));
      context.stroke();
      context.fillText(cut(words, 8), MARGIN.left - 5, y(at) + 4);
    }
    context.save();
    context.translate(12, MARGIN.top + tall / 2);
    context.rotate(-Math.PI / 2);
    context.textAlign = "center";
    context.fillText(cut(labelY, Math.floor(tall / 6)), 0, 0);
    context.restore();
  }

  return { ...base, x, y, clear, frame, inner };
}

const cut = (words, most) => (words.length > most ? `${words.slice(0, most - 1)}…` : words);

function thinned(ticks, most) {
  const kept = [];
  for (const tick of [...ticks].sort((a, b) => b[0] - a[0])) {
    if (!kept.length || kept.at(-1)[0] - tick[0] >= 1 / Math.max(1, most)) kept.push(tick);
  }
  return kept;
}
