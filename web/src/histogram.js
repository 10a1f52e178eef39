// Histogram of one column: all cases in pale grey, the selected ones before them.
import { scaleLinear } from "d3-scale";
import { theme } from "./colours.js";
import { plot } from "./plot.js";
import { ordered, placesOf, scaleOf } from "./scales.js";
import { count, heading, number } from "./words.js";

const BINS = 32;

export function histogram(model) {
  const base = plot(320, "Histogram");
  const { node, context } = base;

  function draw() {
    const column = model.table.columns.get(model.views.histogram);
    const scale = scaleOf(column);
    const bins = scale.levels ? Math.max(1, column.levels.length) : BINS;
    const [all, chosen] = [new Uint32Array(bins + 2), new Uint32Array(bins + 2)]; // then: unlimited, without a value
    const places = placesOf(column);
    for (let i = 0; i < model.table.count; i++) {
      const at = places[i];
      const bin = Number.isNaN(at) ? bins + 1 : at > 1.001 ? bins : Math.max(0, Math.min(bins - 1, Math.floor(at * bins)));
      all[bin] += 1;
      if (!model.misses[i]) chosen[bin] += 1;
    }
    const scaleY = scaleLinear([0, Math.max(1, ...all)], [0, 1]).nice(4);
    const share = (n) => scaleY(n);
    const { mark, line, ink } = theme();
    base.clear();
    const ticks = scaleY.ticks(4).filter(Number.isInteger).map((k) => [share(k), count(k)]);
    base.frame(scale, { ticks, levels: false }, heading(column), "Cases");
    const bars = [...Array.from({ length: bins }, (_, k) => [k / bins, (k + 1) / bins]), [1.01, 1.04], [-0.04, -0.01]];
    bars.forEach(([from, to], k) => {
      const [left, width] = [base.x(from), Math.max(1, base.x(to) - base.x(from) - 1)];
      for (const [n, colour] of [[all[k], line], [chosen[k], mark]]) {
        context.fillStyle = colour;
        context.fillRect(left, base.y(share(n)), width, base.y(0) - base.y(share(n)));
      }
      context.strokeStyle = ink;
      context.lineWidth = 0.5;
      if (chosen[k]) context.strokeRect(left, base.y(share(chosen[k])), width, base.y(0) - base.y(share(chosen[k])));
    });
    const told = said(column, chosen[bins], chosen[bins + 1]);
    node.setAttribute("aria-label", told);
    return told;
  }

  function said(column, unlimited, missing) {
    const parts = [`${heading(column)} of ${count(model.count)} selected cases`];
    if (!scaleOf(column).levels) {
      const values = finite(column, model);
      if (values.length) parts.push(`median ${number(values[values.length >> 1], 3)}, from ${number(values[0], 3)} to ${number(values[values.length - 1], 3)}`);
    }
    if (unlimited) parts.push(`${count(unlimited)} unlimited`);
    if (missing) parts.push(`${count(missing)} without a value (at the left edge)`);
    return `${parts.join("; ")}.`;
  }

  return { node, fit: base.fit, draw };
}

// Finite values of the selected cases in rising order.
function finite(column, model) {
  const found = new Float64Array(model.count);
  let n = 0;
  for (const row of ordered(column)) if (!model.misses[row] && Number.isFinite(column.values[row])) found[n++] = column.values[row];
  return found.subarray(0, n);
}
