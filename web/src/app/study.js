// A study from what is on the screen: factors by a click, outputs and design, the live plan, and the study file as text.
import { ask } from "./api.js";
import { el, replace, select } from "../dom.js";

const PAUSE = 300; // ms without a change until the study is checked
// The numbers of each kind for values from `low` to `high`.
const RANGED = {
  values: (low, high) => [low, (low + high) / 2, high],
  linspace: (low, high) => [low, high, 5],
  logspace: (low, high) => [low, high, 5],
  uniform: (low, high) => [low, high],
  loguniform: (low, high) => [low, high],
  normal: (low, high) => [(low + high) / 2, (high - low) / 4],
  truncnormal: (low, high) => [(low + high) / 2, (high - low) / 4, low, high],
  triangular: (low, high) => [low, (low + high) / 2, high],
  lognormal: (low, high) => (low * high > 0 ? [Math.sign(low) * Math.sqrt(low * high), Math.abs(Math.log(high / low)) / 4] : [low, 0.5]),
  weibull: (low, high) => [high, 2],
};
const KINDS = {
  values: "list of values",
  linspace: "even steps: first, last, how many",
  logspace: "even ratios: first, last, how many",
  uniform: "uniform: low, high",
  loguniform: "log-uniform: low, high",
  normal: "normal: mean, deviation",
  truncnormal: "cut normal: mean, deviation, low, high",
  triangular: "triangular: low, likely, high",
  lognormal: "log-normal: median, deviation of ln",
  weibull: "Weibull: scale, shape",
  expression: "follows from others (expression)",
};
const DESIGNS = {
  grid: "every combination",
  lhs: "random, evenly spread (Latin hypercube)",
  sobol: "random, evenly spread (Sobol)",
  saltelli: "for sensitivity indices (Saltelli)",
  morris: "which parameters matter at all (Morris)",
  inner_outer: "designs over scattering conditions (inner/outer array)",
  central_composite: "response surface (central composite)",
  box_behnken: "response surface (Box-Behnken)",
  plackett_burman: "screening of many factors (Plackett-Burman)",
  table: "cases of a CSV file",
  optimise: "search for the best designs; goals and budget stand in the text",
};
const SAMPLED = ["lhs", "sobol", "saltelli", "morris", "inner_outer"];

// A list as it is typed: numbers, names, or pairs of materials in brackets. Between semicolons a comma is a decimal sign.
function read(text) {
  const wide = /;/.test(text.replace(/\[[^\]]*\]/g, ""));
  const parts = text.match(wide ? /\[[^\]]*\]|[^;]+/g : /\[[^\]]*\]|[^,]+/g) ?? [];
  const size = (word) => Number(word.trim().replaceAll("−", "-").replace(wide ? "," : /$^/, "."));
  const one = (word) => (word.trim() !== "" && Number.isFinite(size(word)) ? size(word) : /^(inf|∞|straight)$/i.test(word.trim()) ? "inf" : word.trim());
  return parts.map((part) => (part.trim().startsWith("[") ? part.trim().slice(1, -1).split(",").map(one) : one(part))).filter((v) => v !== "");
}
const filled = (mapping) => Object.fromEntries(Object.entries(mapping).filter(([, value]) => value !== "" && (typeof value !== "object" || Object.keys(value ?? {}).length)));
const written = (value) => (Array.isArray(value) ? value.map((v) => (Array.isArray(v) ? `[${v.join(", ")}]` : String(v))).join(", ") : String(value ?? ""));

export function studyView(state, offered, { started }) {
  let study = { name: "my-study", description: "", factors: {} };
  let text = "";
  let [timer, newest] = [0, 0];  // an answer to an earlier text or study would take back what was changed since
  let sound = false;
  let taken = []; // options of the roller on the screen
  const roleOf = (name) => offered.parameters.find((p) => p.name === name)?.role ?? "choice";
  const labelOf = (name) => offered.parameters.find((p) => p.name === name)?.label ?? name.replaceAll("_", " ").replace(/^./, (c) => c.toUpperCase());

  const saidOf = new Map(); // messages by the first two parts of their field
  const message = (field) => {
    const said = el("span", { class: "said", role: "status" });
    saidOf.set(field, said);
    return said;
  };
  const input = (key, label, attributes = {}) => {
    const field = el("input", { type: "text", autocomplete: "off", ...attributes, onchange: () => set(key, attributes.inputmode ? Number(field.value) || field.value : field.value) });
    return { field, node: el("label", { class: "line" }, el("span", {}, label), field, message(key)) };
  };
  const name = input("name", "Name");
  const question = input("description", "Question");
  const method = select("Method", offered.designs.map((d) => [d, `${d}: ${DESIGNS[d] ?? d}`]), "grid", (value) => set("method", value));
  const samples = input("samples", "Samples", { inputmode: "numeric", placeholder: "1024" });
  const words = (option) => offered.options.find((o) => o.name === option).values;
  const model = select("Contact model", Object.keys(words("contact_model")).map((m) => [m, m]), "kalker", (value) => set("contact_model", value));
  const accuracy = select("Accuracy", Object.keys(words("accuracy")).map((a) => [a, a]), "standard", (value) => set("accuracy", value));
  const outputs = Object.entries(words("outputs")).map(([group, meaning]) => {
    const box = el("input", { type: "checkbox", value: group, onchange: () => set("outputs", outputs.filter((o) => o.box.checked).map((o) => o.group)) });
    return { group, box, node: el("label", { title: meaning }, box, ` ${group.replaceAll("_", " ")}`) };
  });
  const factors = el("div", { class: "factors" });
  const base = el("p", { class: "soft" });
  const area = el("textarea", { spellcheck: false, rows: 22, "aria-label": "Study file", "aria-describedby": "study-said" });
  const said = el("ul", { class: "warnings", id: "study-said", role: "status" });
  const plan = el("dl", { class: "plan" });
  const go = el("button", { type: "button", class: "main", disabled: true, onclick: () => run() }, "Run the study");
  const ran = el("p", { role: "status" });
  area.addEventListener("input", () => later({ text: area.value }));

  function set(key, value) {
    if (value === "" || value === null || (Array.isArray(value) && !value.length)) delete study[key];
    else study[key] = value;
    later({ study });
  }
  function later(body) {
    clearTimeout(timer);
    newest += 1;
    go.disabled = true;
    timer = setTimeout(() => check(body), PAUSE);
  }

  async function check(body) {
    const own = (newest += 1);
    try {
      const answer = await ask("checked", body.study ? { study: filled(body.study) } : body);
      if (own !== newest) return;
      text = answer.text;
      if (document.activeElement !== area) area.value = text;
      if (answer.study) (study = answer.study).factors ??= {};
      if (answer.study && body.text !== undefined) fill();
      tell(answer);
    } catch (error) {
      if (own === newest) tell({ errors: error.errors ?? [{ field: "", message: String(error) }], plan: [], doubts: [] });
    }
  }

  function tell({ errors, plan: rows, doubts }) {
    sound = errors.length === 0 && rows.length > 0;
    go.disabled = !sound;
    for (const node of saidOf.values()) node.textContent = "";
    for (const { field, message: words } of errors) {
      const [head, second] = field.split(/[.\s(]/);
      (saidOf.get(`${head}.${second}`) ?? saidOf.get(head) ?? {}).textContent = words;
    }
    replace(said, [...errors.map((e) => e.message), ...doubts.map((d) => `Doubtful: ${d}`)].map((words) => el("li", {}, words)));
    replace(plan, rows.flatMap(([head, words]) => [el("dt", {}, head), el("dd", {}, words)]));
  }

  function factor(key) {
    const spec = study.factors[key] ?? {};
    const kind = Object.keys(spec).find((k) => k in KINDS) ?? "values";
    const kinds = el("select", { "aria-label": `${labelOf(key)}: kind of values` }, Object.entries(KINDS).map(([k, words]) => el("option", { value: k }, words)));
    kinds.value = kind;
    const field = el("input", { type: "text", value: written(spec[kind]), "aria-label": `${labelOf(key)}: values`, autocomplete: "off" });
    const change = () => {
      const value = kinds.value === "expression" ? field.value : read(field.value);
      study.factors[key] = { ...(spec.weights && kinds.value === "values" ? { weights: spec.weights } : {}), [kinds.value]: value };
      later({ study });
    };
    kinds.addEventListener("change", () => {
      const before = Object.keys(study.factors[key] ?? {}).find((k) => k in KINDS);
      const numbers = read(field.value).filter((v) => typeof v === "number");
      const [one, two] = numbers;
      const [low, high] = before === "normal" ? [one - 2 * two, one + 2 * two] : before === "truncnormal" ? numbers.slice(2) : before?.endsWith("space") ? [one, two] : [Math.min(...numbers), Math.max(...numbers)];
      if (numbers.length > 1 && RANGED[kinds.value]) field.value = written(RANGED[kinds.value](low, high).map((v) => Number(v.toPrecision(4))));
      change();
    });
    field.addEventListener("change", change);
    const role = select("set by", [["choice", "designer's choice"], ["condition", "condition of use"]], study.roles?.[key] ?? roleOf(key), (value) => {
      study.roles = { ...study.roles, [key]: value };
      if (value === roleOf(key)) delete study.roles[key];
      later({ study });
    });
    role.field.setAttribute("aria-label", `${labelOf(key)}: who sets it`);
    const away = el("button", { type: "button", class: "mini", "aria-label": `Remove the factor ${labelOf(key)}`, onclick: () => remove(key) }, "✕");
    return el("div", { class: "factor" }, el("strong", {}, labelOf(key)), kinds, field, role.field, away, message(`factors.${key}`));
  }

  function remove(key) {
    delete study.factors[key];
    if (study.roles) delete study.roles[key];
    fill();
    later({ study });
  }

  function fill() {
    for (const [key, part] of [["name", name], ["description", question], ["samples", samples]]) if (document.activeElement !== part.field) part.field.value = study[key] ?? "";
    method.field.value = study.method ?? study.design ?? "grid"; // the other name of the key
    samples.node.hidden = !SAMPLED.includes(method.field.value);
    if (typeof (study.contact_model ?? "kalker") === "string") model.field.value = study.contact_model ?? "kalker";
    accuracy.field.value = study.accuracy ?? "standard";
    const chosen = Array.isArray(study.outputs) ? study.outputs : offered.options.find((o) => o.name === "outputs").value;
    for (const { group, box } of outputs) box.checked = chosen.includes(group);
    for (const key of [...saidOf.keys()]) if (key.startsWith("factors.")) saidOf.delete(key);
    replace(factors, Object.keys(study.factors).length ? Object.keys(study.factors).map(factor) : el("p", { class: "soft" }, "Choose factors with + beside a field of the roller, or here."));
    const fixed = Object.entries(study.base ?? {}).map(([key, value]) => `${labelOf(key)} ${typeof value === "object" ? JSON.stringify(value) : value}`);
    base.textContent = `${fixed.length ? `The same in all cases: ${fixed.join(", ")}. ` : ""}All other values are those of the paper's example.`;
  }
  method.field.addEventListener("change", () => (samples.node.hidden = !SAMPLED.includes(method.field.value)));

  // The roller on the screen becomes what all cases share; options become options. The server reads the texts.
  async function takeRoller() {
    const lines = Object.entries(state.values).map(([key, value]) => `${key}: ${value}`);
    const answer = lines.length ? await ask("checked", { text: lines.join("\n") }, "roller").catch((error) => error) : { study: {} };
    if (!answer.study) return tell({ errors: answer.errors, plan: [], doubts: [] });
    const options = [...offered.options.map((o) => o.name), "duty"];
    const given = Object.entries(answer.study);
    for (const key of taken) delete study[key];
    study.base = Object.fromEntries(given.filter(([key]) => !options.includes(key) && key !== "sheet" && !(key in study.factors)));
    taken = given.map(([key]) => key).filter((key) => options.includes(key));
    for (const key of taken) study[key] = answer.study[key];
    fill();
    check({ study });
  }

  function add(key, range = null) {
    const parameter = offered.parameters.find((p) => p.name === key);
    const now = state.values[key] ?? parameter?.value ?? offered.materials[0].name;
    const size = Number(now);
    const round = (v) => Number(v.toPrecision(3));
    if (range) study.factors[key] = { linspace: RANGED.linspace(...range) };
    else if (!(key in study.factors)) {
      const list = parameter ? (Number.isFinite(size) && now !== null ? (size === 0 ? [0, 10] : [round(size * 0.8), size, round(size * 1.2)]) : [now ?? 1]) : [...new Set([String(now), ...offered.materials.map((m) => m.name)])].slice(0, 2);
      study.factors[key] = { values: list };
    }
    fill();
    state.show("study");
    takeRoller();
  }

  async function run() {
    go.disabled = true;
    try {
      const { name: begun } = await ask("start", { text: area.value });
      ran.textContent = `The study '${begun}' runs. It goes on if you close the page.`;
      started();
    } catch (error) {
      ran.textContent = error.message;
      go.disabled = !sound;
    }
  }

  const choose = select("Add a factor", [["", "choose"], ...offered.parameters.map((p) => [p.name, p.label]), ...offered.bodies.map((b) => [b, labelOf(b)])], "", (key) => {
    if (key) add(key);
    choose.field.value = "";
  });
  const take = el("button", { type: "button", onclick: takeRoller }, "Take the roller on the screen");
  const node = el(
    "div",
    { class: "study" },
    el(
      "section",
      {},
      el("h2", {}, "Study"),
      name.node,
      question.node,
      el("h3", {}, "Factors"),
      factors,
      message("factors"),
      el("div", { class: "tools" }, choose.node, take),
      base,
      message("base"),
      el("h3", {}, "Design"),
      el("div", { class: "tools" }, method.node, message("method")),
      samples.node,
      el("h3", {}, "Results"),
      el("div", { class: "boxes" }, outputs.map((o) => o.node), message("outputs")),
      el("div", { class: "tools" }, model.node, message("contact_model"), accuracy.node, message("accuracy")),
    ),
    el("section", {}, el("h2", {}, "Plan"), plan, said, el("div", { class: "tools" }, go), ran, el("h2", {}, "Study file"), el("p", { class: "soft" }, "Edit the text or the fields: each follows the other."), area),
  );
  fill();
  return {
    node,
    add,
    draw: () => text === "" && takeRoller(),
    open(content) {
      state.show("study");
      area.value = content;
      check({ text: content });
    },
  };
}
