// A row for every parameter of a case: name, slider, number field and unit, and what can be done with it.
import { el, replace } from "../dom.js";
import { number } from "../words.js";

const STEPS = 160; // of a slider with a logarithmic scale
const RANGE = /^([-+]?\d[\d.,]*)\s*(?:-|–|—|…|\.{2,3}|to|bis)\s*([-+]?\d[\d.,]*)$/i; // such as 0.12-0.25
const STRAIGHT = /^\+?(straight|flat|∞|infinity|infinite)$/i;
const FACTOR = 4; // a slider spans a quarter to four times a value that lies outside of its ends

export const symbol = (text) => {
  const greek = { alpha: "α", mu: "μ", nu: "ν", rho: "ρ", sigma: "σ", tau: "τ", theta: "θ", xi: "ξ" };
  return text.split(/(\b[A-Za-z]+_[A-Za-z0-9]+(?:,[A-Z]+)?|\b(?:alpha|mu|nu|rho|xi)\b)/).map((part, i) => {
    if (i % 2 === 0) return part;
    const [letter, index] = part.split("_");
    const sign = greek[letter] ?? letter;
    if (sign.length > 2) return part;
    return el("span", { class: "symbol" }, el("i", {}, sign), index ? el("sub", {}, index.replace(/^Delta/, "Δ")) : null);
  });
};

const asNumber = (value) => (value === "inf" ? Infinity : value === "-inf" ? -Infinity : Number(value));
export const textOf = (value) => (value === Infinity || value === "inf" ? "inf" : value === null || value === undefined ? "" : String(value));

function nice(step) {
  const power = 10 ** Math.floor(Math.log10(step));
  return [1, 2, 5, 10].map((k) => k * power).find((k) => k >= step * 0.999);
}

// The scale between the places of a slider and values.
function scaleOf([low, high]) {
  if (low * high > 0 && Math.max(low / high, high / low) > 2) {
    const ratio = high / low;
    return {
      ends: [0, STEPS, 1],
      value: (place) => Number((low * ratio ** (place / STEPS)).toPrecision(3)),
      place: (value) => (value * low > 0 ? (STEPS * Math.log(value / low)) / Math.log(ratio) : 0),
    };
  }
  const step = nice((high - low) / 200);
  return { ends: [low, high, step], value: (place) => Number(Number(place).toPrecision(6)), place: (value) => value };
}

function endsFor(parameter, value) {
  const ends = parameter.ends;
  if (!Number.isFinite(value)) return ends;
  if (ends && value >= ends[0] && value <= ends[1]) return ends;
  if (value === 0) return ends ? [Math.min(0, ends[0]), Math.max(0, ends[1])] : null;
  return [value / FACTOR, value * FACTOR].sort((a, b) => a - b);
}

// A row tells `change(value, moving)`; `set` shows a value, `complain` a message beside the field.
// `ask` puts a question with an answer to click, such as what is meant by a range.
export function parameterRow(parameter, { change, curve, factor }) {
  const { name, label, unit, meaning } = parameter;
  const id = `field-${name}`;
  let scale = null;
  const range = el("input", { type: "range", "aria-label": `${label}, slider` });
  const field = el("input", { type: "text", id, inputmode: "decimal", autocomplete: "off", spellcheck: false, "aria-describedby": `${id}-said`, "data-field": name });
  const said = el("span", { class: "said", id: `${id}-said`, role: "status" });
  const asked = el("span", { class: "asked", role: "status" });
  const ask = (words, answer, act) => replace(asked, words, " ", el("button", { type: "button", class: "mini", onclick: () => (replace(asked), act()) }, answer));
  let known = "";
  const straight = parameter.infinite
    ? el("button", { type: "button", class: "mini", title: "straight: infinite radius", "aria-label": `${label}: straight`, onclick: () => change(field.value === "inf" ? null : "inf") }, "∞")
    : null;
  const tools = [
    straight,
    curve && (parameter.ends || parameter.optional)
      ? el("button", { type: "button", class: "mini", title: `Curve over ${label.toLowerCase()}`, "aria-label": `Curve over ${label}`, onclick: curve }, "∿")
      : null,
    factor ? el("button", { type: "button", class: "mini", title: "Make it a factor of the study", "aria-label": `Make ${label} a factor of the study`, onclick: () => factor() }, "+") : null,
  ];
  const name_ = el("label", { for: id, title: `${meaning} (${parameter.allowed})` }, label, " ", symbol(parameter.symbol));
  const node = el("div", { class: "field" }, name_, range, field, el("span", { class: "unit" }, unit), el("span", { class: "tools" }, tools), said, asked);
  range.addEventListener("input", () => {
    const value = scale.value(Number(range.value));
    field.value = String(value);
    range.setAttribute("aria-valuetext", `${value} ${unit}`);
    change(value, true);
  });
  range.addEventListener("change", () => change(scale.value(Number(range.value))));
  field.addEventListener("change", () => {
    const typed = field.value.trim().replaceAll("−", "-");
    const range = typed.match(RANGE)?.slice(1).map((end) => Number(end.replace(",", ".")));
    replace(asked);
    if (factor && range?.every(Number.isFinite)) {
      field.value = known;
      const [low, high] = range.sort((a, b) => a - b);
      return ask(`Is ${typed} a range?`, "Make it a factor of the study", () => factor([low, high]));
    }
    if (parameter.infinite && STRAIGHT.test(typed)) return change("inf");
    const value = typed.replace(",", ".");
    change(value === "" ? null : value);
    if (name === "roller_profile_radius" && Number(value) > 0 && Number.isFinite(Number(value))) ask("A radius > 0 is a convex roller. Is a groove meant?", `−${value}`, () => change(`-${value}`));
  });
  return {
    node,
    name,
    set(given) {
      const value = given === "" ? null : (given ?? parameter.value); // "" follows from other fields
      const size = value === null ? NaN : asNumber(value);
      known = textOf(value);
      if (document.activeElement !== field) field.value = known;
      node.classList.toggle("given", given !== undefined && given !== "");
      field.placeholder = given === "" ? "follows" : parameter.optional ? "none" : "";
      const ends = endsFor(parameter, size);
      range.hidden = ends === null;
      range.disabled = !Number.isFinite(size);
      straight?.setAttribute("aria-pressed", String(size === Infinity));
      if (ends === null || document.activeElement === range) return;
      scale = scaleOf(ends);
      [range.min, range.max, range.step] = scale.ends.map(String);
      if (Number.isFinite(size)) range.value = String(scale.place(size));
      range.setAttribute("aria-valuetext", Number.isFinite(size) ? `${number(size)} ${unit}` : "straight");
    },
    complain(message) {
      if (message) node.closest("details")?.setAttribute("open", "");
      said.textContent = message ?? "";
      node.classList.toggle("wrong", Boolean(message));
      field.setAttribute("aria-invalid", String(Boolean(message)));
    },
    ends: () => (scale ? [scale.value(Number(range.min)), scale.value(Number(range.max))] : null),
  };
}

// A text field or a choice, for materials, profiles, laws and options.
export function wordRow({ name, label, meaning, words = null, list = null, fallback = "" }, { change, factor }) {
  const id = `field-${name}`;
  const shared = { id, "data-field": name, "aria-describedby": `${id}-said` };
  const field = words
    ? el("select", shared, Object.entries(words).map(([value, text]) => el("option", { value, title: text }, value)))
    : el("input", { type: "text", autocomplete: "off", spellcheck: false, ...shared, list });
  const said = el("span", { class: "said", id: `${id}-said`, role: "status" });
  const facts = el("span", { class: "facts" });
  const more = factor
    ? el("button", { type: "button", class: "mini", title: "Make it a factor of the study", "aria-label": `Make ${label} a factor of the study`, onclick: factor }, "+")
    : null;
  field.addEventListener("change", () => change(field.value.trim() === fallback ? null : field.value.trim()));
  const node = el("div", { class: "field words" }, el("label", { for: id, title: meaning }, label), field, el("span", { class: "tools" }, more), facts, said);
  return {
    node,
    name,
    set(given) {
      if (document.activeElement !== field) field.value = textOf(given ?? fallback);
      node.classList.toggle("given", given !== undefined);
    },
    tell: (text) => replace(facts, text),
    complain(message) {
      if (message) node.closest("details")?.setAttribute("open", "");
      said.textContent = message ?? "";
      node.classList.toggle("wrong", Boolean(message));
      field.setAttribute("aria-invalid", String(Boolean(message)));
    },
  };
}
