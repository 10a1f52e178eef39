// Maps of both patches on canvases: a field in colours, the adhesion area, the spin pole; or the stress below them.
import { CIVIDIS, mixed, parsed, theme } from "../colours.js";
import { canvas, el, replace } from "../dom.js";
import { number } from "../words.js";

const HEIGHT = 124;
const FOOT = 22; // room for the ends of the axes

const ramp = Uint8ClampedArray.from({ length: 256 * 3 }, (_, i) => {
  const at = (Math.floor(i / 3) / 255) * (CIVIDIS.length - 1);
  const k = Math.min(Math.floor(at), CIVIDIS.length - 2);
  return parsed(mixed(CIVIDIS[k], CIVIDIS[k + 1], at - k))[i % 3];
});

const bytes = (text) => Uint8Array.from(atob(text), (sign) => sign.charCodeAt(0));

function picture(values, [nx, ny], share, inside = null) {
  const part = document.createElement("canvas");
  [part.width, part.height] = [nx, ny];
  const context = part.getContext("2d");
  const data = context.createImageData(nx, ny);
  for (let i = 0; i < nx * ny; i++) {
    const to = ((ny - 1 - Math.floor(i / nx)) * nx + (i % nx)) * 4; // y points up
    const colour = Math.min(255, Math.round(values[i] * share));
    for (let k = 0; k < 3; k++) data.data[to + k] = ramp[3 * colour + k];
    data.data[to + 3] = inside && !inside[i] ? 0 : 255;
  }
  context.putImageData(data, 0, 0);
  return part;
}

// One scale for all maps of a picture: `box` holds the largest ends.
function map(label) {
  const surface = canvas(HEIGHT, label);
  const caption = el("figcaption", {});
  const node = el("figure", { class: "map" }, surface.node, caption);
  function place(box) {
    surface.fit(Math.max(120, Math.floor(node.clientWidth || 180)), HEIGHT);
    const [wide, tall] = [surface.size.width - 8, HEIGHT - FOOT];
    const scale = Math.min(wide / (box.x[1] - box.x[0]), tall / (box.y[1] - box.y[0]));
    const [cx, cy] = [(box.x[0] + box.x[1]) / 2, (box.y[0] + box.y[1]) / 2];
    return { x: (v) => surface.size.width / 2 + (v - cx) * scale, y: (v) => tall / 2 + 2 - (v - cy) * scale, scale };
  }
  function bar(at, length) {
    const { context } = surface;
    const { ink } = theme();
    const wanted = 10 ** Math.floor(Math.log10(length / 1.5));
    const size = [5, 2, 1].map((k) => k * wanted).find((k) => k <= length / 1.5) ?? wanted;
    context.fillStyle = ink;
    context.fillRect(6, HEIGHT - 14, size * at.scale, 2);
    context.font = "11px system-ui, sans-serif";
    context.fillText(`${number(size, 2)} mm`, 12 + size * at.scale, HEIGHT - 9);
  }
  return { node, surface, caption, place, bar };
}

export function maps() {
  const parts = [1, 2].map((contact) => map(`Contact ${contact}`));
  const legend = el("p", { class: "ramp", "aria-hidden": "true" });
  const signs = el("p", { class: "ramp" });
  const node = el("div", { class: "maps" }, parts.map((part) => part.node), legend, signs);

  function legendOf(field, top) {
    replace(legend, "0", el("canvas", { class: "scale", width: 128, height: 1 }), `${number(top, 3)} ${field.unit} ${field.words}`);
    const scale = legend.querySelector("canvas");
    const line = picture(Uint8Array.from({ length: 128 }, (_, i) => 2 * i), [128, 1], 1);
    scale.getContext("2d").drawImage(line, 0, 0);
  }

  function patches(found, kind) {
    const box = { x: [Math.min(...found.map((p) => edge(p).x[0])), Math.max(...found.map((p) => edge(p).x[1]))], y: [Math.min(...found.map((p) => edge(p).y[0])), Math.max(...found.map((p) => edge(p).y[1]))] };
    const top = Math.max(...found.map((p) => p.fields[kind].top));
    parts.forEach((part, i) => {
      const patch = found.find((p) => p.contact === i + 1);
      const { context, size } = part.surface;
      const at = part.place(box);
      context.clearRect(0, 0, size.width, HEIGHT);
      replace(part.caption, `Contact ${i + 1}`);
      if (!patch) return part.caption.append(": has lifted off");
      const field = patch.fields[kind];
      fill(context, at, patch, picture(bytes(field.data), patch.size, top > 0 ? field.top / top : 0, patch.ellipse ? null : bytes(patch.inside)));
      adhesion(context, at, patch);
      pole(context, at, patch);
      part.bar(at, box.x[1] - box.x[0]);
      const words = `largest ${field.words} ${number(field.top, 3)} ${field.unit}`;
      part.caption.append(`: ${number(field.top, 3)} ${field.unit}`);
      part.surface.node.setAttribute("aria-label", `Contact ${i + 1}: ${words}${patch.pole ? `, spin pole at x = ${number(patch.pole[0], 3)} mm` : ""}`);
    });
    signs.textContent = found.length ? "Up: rolling direction. Dot: spin pole. White: adhesion." : "";
    if (found.length) legendOf(found[0].fields[kind], top);
    else replace(legend);
  }

  function edge(patch) {
    const [a, b] = patch.ellipse ?? [0, 0];
    return { x: [Math.min(patch.x[0], -a), Math.max(patch.x[1], a)], y: [Math.min(patch.y[0], -b), Math.max(patch.y[1], b)] };
  }

  function fill(context, at, patch, image) {
    const [nx, ny] = patch.size;
    const [dx, dy] = [(patch.x[1] - patch.x[0]) / (nx - 1), (patch.y[1] - patch.y[0]) / (ny - 1)];
    const [left, top] = [at.x(patch.x[0] - dx / 2), at.y(patch.y[1] + dy / 2)];
    context.save();
    outline(context, at, patch);
    if (patch.ellipse) context.clip();
    context.imageSmoothingEnabled = true;
    context.drawImage(image, left, top, nx * dx * at.scale, ny * dy * at.scale);
    context.restore();
    if (patch.ellipse) {
      outline(context, at, patch);
      context.strokeStyle = theme().ink;
      context.lineWidth = 1;
      context.stroke();
    }
  }

  function outline(context, at, patch) {
    context.beginPath();
    if (patch.ellipse) context.ellipse(at.x(0), at.y(0), patch.ellipse[0] * at.scale, patch.ellipse[1] * at.scale, 0, 0, 2 * Math.PI);
  }

  function adhesion(context, at, patch) {
    const still = bytes(patch.adhesion);
    const [nx, ny] = patch.size;
    const [dx, dy] = [(patch.x[1] - patch.x[0]) / (nx - 1), (patch.y[1] - patch.y[0]) / (ny - 1)];
    context.strokeStyle = "#fff";
    context.lineWidth = 1;
    for (let i = 0; i < nx * ny; i++) {
      if (!still[i]) continue;
      context.strokeRect(at.x(patch.x[0] + ((i % nx) - 0.5) * dx), at.y(patch.y[0] + (Math.floor(i / nx) + 0.5) * dy), dx * at.scale, dy * at.scale);
    }
  }

  function pole(context, at, patch) {
    if (!patch.pole) return;
    const [x, y] = [at.x(patch.pole[0]), at.y(patch.pole[1])];
    if (x < 0 || y < 0 || x > context.canvas.width || y > HEIGHT) return;
    context.beginPath();
    context.arc(x, y, 3.5, 0, 2 * Math.PI);
    context.fillStyle = "#c03a00";
    context.strokeStyle = "#fff";
    context.fill();
    context.stroke();
  }

  // The section across the track below each contact; depth points down.
  function sections(found, body) {
    const own = found.filter((one) => one.body === body);
    const top = Math.max(0, ...own.map((one) => one.field.top));
    const box = { x: [Math.min(...own.map((s) => s.x[0])), Math.max(...own.map((s) => s.x[1]))], y: [-Math.max(...own.map((s) => s.z[1])), 0] };
    parts.forEach((part, i) => {
      const one = own.find((section) => section.contact === i + 1);
      const at = part.place(box);
      const { context, size } = part.surface;
      context.clearRect(0, 0, size.width, HEIGHT);
      replace(part.caption, `Contact ${i + 1}`);
      if (!one) return part.caption.append(": no stress");
      const flipped = bytes(one.field.data);
      const [nx, nz] = one.size;
      const turned = Uint8Array.from({ length: nx * nz }, (_, k) => flipped[(nz - 1 - Math.floor(k / nx)) * nx + (k % nx)]);
      context.drawImage(picture(turned, one.size, one.field.top / top), at.x(one.x[0]), at.y(-one.z[0]), (one.x[1] - one.x[0]) * at.scale, (one.z[1] - one.z[0]) * at.scale);
      part.bar(at, box.x[1] - box.x[0]);
      part.caption.append(`: ${number(one.field.top, 3)} ${one.field.unit}`);
      part.surface.node.setAttribute("aria-label", `Contact ${i + 1}, ${body}: largest von Mises stress ${number(one.field.top, 3)} MPa below the surface`);
    });
    signs.textContent = "Sections across the track; depth points down.";
    if (own.length) legendOf(own[0].field, top);
  }

  return { node, patches, sections };
}
