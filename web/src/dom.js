// Elements without markup in strings: names of users only ever become text.
export function el(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) node.addEventListener(key.slice(2), value);
    else if (key in node && typeof value !== "string") node[key] = value;
    else if (value !== null && value !== undefined) node.setAttribute(key, value);
  }
  node.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return node;
}

export function select(label, options, value, change) {
  const field = el("select", { onchange: () => change(field.value) });
  for (const [key, text] of options) field.append(el("option", { value: key }, text));
  field.value = value;
  return { node: el("label", {}, `${label} `, field), field };
}

export function replace(node, ...children) {
  node.replaceChildren(...children.flat().filter((child) => child !== null && child !== undefined));
}

export const reducedMotion = () => matchMedia("(prefers-reduced-motion: reduce)").matches;

export async function copy(text, button) {
  const before = button.textContent;
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const field = el("textarea", { "aria-hidden": "true" });
    field.value = text;
    document.body.append(field);
    field.select();
    document.execCommand("copy");
    field.remove();
  }
  button.textContent = "Copied";
  setTimeout(() => (button.textContent = before), 1500);
}

export function download(name, text, type) {
  const url = URL.createObjectURL(new Blob([text], { type }));
  el("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 1000);
}

// A canvas that fills the width of its place and keeps sharp on every screen.
export function canvas(height, label) {
  const node = el("canvas", { role: "img", "aria-label": label });
  const context = node.getContext("2d");
  const size = { width: 0, height, ratio: 1 };
  function fit(width, tall = height) {
    size.ratio = Math.min(2, devicePixelRatio || 1);
    [size.width, size.height] = [width, tall];
    node.width = Math.round(width * size.ratio);
    node.height = Math.round(tall * size.ratio);
    node.style.width = `${width}px`;
    node.style.height = `${tall}px`;
    context.setTransform(size.ratio, 0, 0, size.ratio, 0, 0);
  }
  return { node, context, size, fit };
}
