// A carriage on track rollers: fields, picture and text of its file, each of which follows the others.
// The server keeps the comments of the text when a field or the picture changes a value.
import { ask } from "./api.js";
import { el, replace, select } from "../dom.js";
import { carriagePicture } from "./carriage_picture.js";
import { headlineOf, part } from "./tables.js";

const PAUSE = 300; // ms without a change of the text until it is read
const REST = 500; // ms without a change until lives and margins are computed
const CASES = [
  ["name", "name"],
  ["share", "share"],
  ["acceleration", "acceleration"],
  ["speed", "speed"],
  ["curve_radius", "curve radius"],
  ["gradient", "gradient"],
  ["cant", "cant"],
  ["payload", "payload"],
];
const SHORT = ["share", "gradient", "cant", "payload"]; // have short fields
const NEW = {
  payloads: "{value: 10 kg, at: [0, 0, 100]}",
  cases: (n) => `{name: case ${n}, share: 0, speed: 1 m/s}`,
};

const written = (value) => (Array.isArray(value) ? `[${value.map(written).join(", ")}]` : value === null || value === undefined ? "" : String(value));
const at = (values, path) => path.reduce((place, key) => place?.[key], values);
const isMapping = (value) => value !== null && typeof value === "object" && !Array.isArray(value);

export function carriageView(state, { changed }) {
  let text = "";
  let file = ""; // its name in the folder; "" for the example
  let values = null;
  let example = "";
  let shownCase = ""; // "" for the worst one
  let pending = []; // changes that the server has not confirmed yet
  let [newest, timer, resting] = [0, 0, 0];
  let [wish, busy] = [null, false]; // the newest question, and whether one is on its way
  let [past, future] = [[], []];
  let opening = false;
  let last = ""; // what the newest step of undo changed
  let [signature, cells, rowsOf] = ["", new Map(), new Map()];

  // files
  const choice = select("Carriage", [], "", (name) => open(name));
  const name = el("input", { type: "text", autocomplete: "off", spellcheck: false, "aria-label": "Name of the file", placeholder: "shuttle.yaml" });
  const save = el("button", { type: "button", onclick: () => store() }, "Save");
  const told = el("span", { role: "status" });

  // what is seen
  const verdict = el("p", { class: "verdict", role: "status", "aria-live": "polite" });
  const stage = el("span", { class: "stage" });
  const cases = select("Load case", [], "", (wanted) => {
    shownCase = wanted;
    paint();
  });
  const picture = carriagePicture({ moved: move });
  const loads = el("div", { class: "wide", tabindex: "0", role: "region", "aria-label": "Loads of the rollers by statics" });
  const lives = el("div", { class: "wide", tabindex: "0", role: "region", "aria-label": "Lives and margins" });
  const sentences = el("ul", { class: "sentences" });
  let [places, forces] = [null, null];

  // what is set
  const masses = el("div", { class: "wide" });
  const rollers = el("div", { class: "wide" });
  const loadCases = el("div", { class: "wide cases" });
  const area = el("textarea", { spellcheck: false, rows: 24, "aria-label": "Carriage file", "aria-describedby": "carriage-said" });
  const said = el("ul", { class: "warnings", id: "carriage-said", role: "status" });
  area.addEventListener("input", () => {
    clearTimeout(timer);
    newest += 1;
    timer = setTimeout(() => send({ text: area.value }, "text"), PAUSE);
  });

  // `what` names a change: steps with the same name, such as those of a movement, are one step of undo.
  // One question is on its way at a time: two could overtake each other.
  function send(body, what, keep = true) {
    newest += 1;
    clearTimeout(resting);
    stage.dataset.stage = "asked";
    wish = { body, what, keep, number: newest };
    work();
  }

  async function work() {
    if (busy || !wish) return;
    const { body, what, keep, number } = wish;
    [wish, busy] = [null, true];
    let answer;
    try {
      answer = await ask("carriage_loads", { file, ...body });
    } catch (error) {
      answer = { text: body.text, values: null, places: null, loads: null, errors: error.errors ?? [{ field: "", message: String(error) }] };
    }
    busy = false;
    if (number !== newest) return work();
    pending = [];
    if (keep && answer.text !== text && what !== last) {
      past.push({ text, file });
      future = [];
    }
    if (keep) last = what;
    text = answer.text;
    if (document.activeElement !== area || what !== "text") area.value = text;
    tell(answer);
    changed();
  }

  // A change replaces an earlier one of the same value that is still on its way.
  function change(list, what) {
    clearTimeout(timer);
    for (const one of list) {
      const key = JSON.stringify(one.path);
      if (one.value !== null) pending = pending.filter((other) => JSON.stringify(other.path) !== key);
      pending.push(one);
    }
    send({ text, changes: pending }, what);
  }

  // A roller of a pair with preload takes its partner along, so that the two press against each other.
  function move(kind, index, place) {
    const set = (path, point) => point.map((value, axis) => ({ path: [...path, axis], value: String(value) }));
    if (kind === "mass") return change(set(index ? ["payloads", index - 1, "at"] : ["mass", "at"], place), `mass ${index}`);
    const own = places.rollers[index];
    const list = set(["rollers", own.name, "at"], place);
    const pair = values?.preload?.find?.((one) => one?.pair?.map?.(String).includes(own.name))?.pair.map(String);
    const partner = pair && places.rollers.find((one) => one.name !== own.name && pair.includes(one.name));
    if (partner) {
      const apart = place.map((value, axis) => value - partner.at[axis]);
      const along = apart.reduce((sum, value, axis) => sum + value * own.pushes[axis], 0);
      partner.at = place.map((value, axis) => Number((value - along * own.pushes[axis]).toFixed(6)));
      list.push(...set(["rollers", partner.name, "at"], partner.at));
    }
    change(list, `roller ${index}`);
  }

  function tell({ values: found, errors, places: seen, loads: carried }) {
    if (found) {
      values = found;
      fill();
    }
    complain(errors);
    if (seen) places = seen;
    forces = carried;
    stage.textContent = carried ? "loads: statics, now" : "shown: the last carriage that could be solved";
    stage.dataset.stage = carried ? "loads" : "refused";
    if (places) {
      const names = [["", "the worst one"], ...places.cases.map((one) => [one, one])];
      if (names.map(String).join() !== [...cases.field.options].map((o) => [o.value, o.label]).map(String).join()) replace(cases.field, names.map(([value, words]) => el("option", { value }, words)));
      if (!places.cases.includes(shownCase)) shownCase = "";
      cases.field.value = shownCase;
    }
    paint();
    for (const one of [loads, sentences, lives]) one.classList.toggle("old", !carried || one === lives);
    if (!carried) return (verdict.textContent = "Not solved. Mend what is marked.");
    replace(verdict, headlineOf(carried.headline));
    replace(sentences, carried.warnings.map((words) => el("li", {}, words)));
    replace(loads, table(carried.table, spectrum));
    resting = setTimeout(live, REST);
  }

  function paint() {
    if (places) picture.show(places, forces, places.cases.indexOf(shownCase || forces?.worst));
  }

  async function live() {
    const own = newest;
    stage.textContent = "lives and margins follow";
    stage.dataset.stage = "solving";
    try {
      const answer = await ask("carriage_lives", { text, file });
      if (own !== newest) return;
      replace(verdict, headlineOf(answer.headline));
      replace(sentences, answer.warnings.map((words) => el("li", {}, words)));
      replace(lives, answer.tables.flatMap((one) => [el("h3", {}, one.name === "limits" ? "Rollers" : one.title), part(one)].flat()));
      lives.classList.remove("old");
      stage.textContent = "shown: loads, lives and margins";
      stage.dataset.stage = "complete";
    } catch (error) {
      if (own !== newest) return;
      complain(error.errors ?? [{ field: "", message: String(error) }]);
      stage.textContent = "lives and margins are not known";
      stage.dataset.stage = "refused";
    }
  }

  function table({ heads, rows, title, note }, button = null) {
    const head = el("tr", {}, heads.map((words) => el("th", { scope: "col" }, words)), button ? el("th", { scope: "col" }, el("span", { class: "hidden" }, "files")) : null);
    const body = rows.map(([first, ...others]) => el("tr", {}, el("th", { scope: "row" }, first), others.map((words) => el("td", {}, words)), button ? el("td", {}, button(first)) : null));
    return el("table", { class: "numbers", title: note, "aria-label": title }, el("thead", {}, head), el("tbody", {}, body));
  }

  const spectrum = (roller) =>
    el("button", { type: "button", class: "mini", "aria-label": `Write the spectrum of roller ${roller}`, title: "a file of this folder, which trackroller spectrum reads", onclick: () => act("carriage_spectrum", { text, file, roller }, ({ file: made }) => `${made} holds the load spectrum of roller ${roller}. Solve it: trackroller spectrum ${made}`) }, "spectrum");

  async function act(question, body, words) {
    try {
      const answer = await ask(question, body);
      told.classList.remove("said");
      told.textContent = words(answer);
      return answer;
    } catch (error) {
      told.classList.add("said");
      told.textContent = error.message;
      return null;
    }
  }

  // files of the folder
  async function list() {
    const found = await ask("carriage_files");
    example = found.example;
    replace(choice.field, [["", "the example: a shuttle"], ...found.files.map((one) => [one, one])].map(([value, words]) => el("option", { value }, words)));
    choice.field.value = found.files.includes(file) ? file : "";
  }

  async function open(wanted) {
    const answer = wanted ? await act("open_carriage", { file: wanted }, () => "") : { text: example };
    if (!answer) return;
    if (text) past.push({ text, file });
    text = answer.text;
    last = "";
    take(wanted);
    send({ text }, "", false);
  }

  function take(wanted) {
    file = state.carriage = wanted;
    name.value = file || "shuttle.yaml";
    choice.field.value = file;
    shownCase = "";
    state.show(state.tab); // the address names the file
  }

  async function store() {
    const answer = await act("save_carriage", { text: area.value, file: name.value, opened: file }, ({ file: made }) => `${made} is saved.`);
    if (!answer) return name.focus();
    take(answer.file);
    list();
  }

  const turn = (from, to) => () => {
    if (!from().length) return;
    to().push({ text, file });
    const before = from().pop();
    if (before.file !== file) take(before.file);
    last = "";
    send({ text: before.text }, "", false);
  };

  // fields: a row for each mass, roller, preload and load case, and below it what is wrong
  function field(path, label, { options = null, kind = "" } = {}) {
    const set = (value) => change([{ path, value: value === "" ? null : value }], JSON.stringify(path));
    const node = options
      ? el("select", { "aria-label": label, onchange: () => set(node.value) }, options.map((value) => el("option", { value }, value)))
      : el("input", { type: "text", autocomplete: "off", spellcheck: false, "aria-label": label, class: kind, onchange: () => set(node.value.trim().replaceAll("−", "-")) });
    node.dataset.path = path.join(".");
    cells.set(JSON.stringify(path), { node, path });
    return node;
  }
  const point = (path, label) => [0, 1, 2].map((axis) => el("td", {}, field([...path, axis], `${label}: ${"xyz"[axis]} [mm]`, { kind: "short" })));
  function row(key, head, content, remove = null) {
    const words = el("span", { class: "said", role: "status", id: `carriage-${key.replace(/\W+/g, "-")}` });
    const note = el("tr", { class: "note", hidden: true }, el("td", { colSpan: 12 }, words));
    rowsOf.set(key, { words, note });
    const away = remove ? el("td", {}, el("button", { type: "button", class: "mini", "aria-label": `Remove ${typeof head === "string" ? head : key}`, onclick: () => change([{ path: remove, value: null }], "") }, "✕")) : null;
    return [el("tr", {}, el("th", { scope: "row" }, head), content, away), note];
  }
  const heads = (first, ...words) => el("thead", {}, el("tr", {}, el("th", { scope: "col" }, el("span", { class: "hidden" }, first)), words.map((word) => el("th", { scope: "col" }, word))));
  const entries = (value) => (Array.isArray(value) ? value : []);

  function build() {
    cells = new Map();
    rowsOf = new Map();
    const mass = (path, label, remove) => row(path.length > 1 ? `${path[0]}[${path[1] + 1}]` : path[0], label, [el("td", {}, field([...path, "value"], `${label}: mass [kg]`)), ...point([...path, "at"], label)], remove);
    replace(
      masses,
      el("table", {}, heads("what", "mass", "x [mm]", "y [mm]", "z [mm]"), el("tbody", {}, mass(["mass"], "carriage"), entries(values.payloads).flatMap((_, i) => mass(["payloads", i], `payload ${i + 1}`, ["payloads", i])), values.drive ? row("drive", "drive", [el("td", {}), ...point(["drive", "at"], "drive")]) : null)),
    );
    const mounted = Object.entries(isMapping(values.rollers) ? values.rollers : {}).flatMap(([one, given]) =>
      row(`rollers.${one}`, one, [
        ...point(["rollers", one, "at"], `roller ${one}`),
        el("td", {}, field(["rollers", one, "pushes"], `roller ${one}: pushes`, { kind: "vector" })),
        el("td", {}, field(["rollers", one, "x_R"], `roller ${one}: x_R`, { kind: "vector" })),
        el("td", {}, field(["rollers", one, "kind"], `roller ${one}: kind`, { options: ["locating", "floating"] })),
        el("td", {}, isMapping(given?.roller) ? "in the text" : field(["rollers", one, "roller"], `roller ${one}: file`)),
      ]),
    );
    const pairs = entries(values.preload).flatMap((one, i) =>
      row(`preload[${i + 1}]`, `${entries(one?.pair).join(" and ")}`, [
        el("td", {}, field(["preload", i, "force"], `preload of ${entries(one?.pair).join(" and ")}: force [N]`)),
        el("td", {}, field(["preload", i, "play"], `preload of ${entries(one?.pair).join(" and ")}: play [mm]`)),
      ]),
    );
    replace(
      rollers,
      el("table", {}, heads("roller", "x [mm]", "y [mm]", "z [mm]", "pushes", "x_R", "kind", "roller"), el("tbody", {}, mounted)),
      pairs.length ? el("table", { class: "narrow" }, heads("pair", "preload [N]", "or play [mm]"), el("tbody", {}, pairs)) : null,
    );
    const given = entries(values.cases);
    replace(
      loadCases,
      el("table", {}, heads("number", ...CASES.map(([, words]) => words)), el("tbody", {}, given.flatMap((_, i) => row(`case ${i}`, String(i + 1), CASES.map(([key, words]) => el("td", {}, field(["cases", i, key], `load case ${i + 1}: ${words}`, { kind: SHORT.includes(key) ? "short" : "" }))), given.length > 1 ? ["cases", i] : null)))),
    );
  }

  function fill() {
    const keys = (value) => (isMapping(value) ? Object.entries(value).map(([one, given]) => [one, isMapping(given?.roller)]) : []);
    const now = JSON.stringify([keys(values.rollers), entries(values.payloads).length, Boolean(values.drive), entries(values.preload).map((one) => one?.pair), entries(values.cases).length]);
    if (now !== signature) build();
    signature = now;
    for (const { node, path } of cells.values()) {
      const value = written(at(values, path));
      if (document.activeElement !== node) node.value = value || (path.at(-1) === "kind" ? "locating" : "");
    }
  }

  // A message stands below the row that its field names; all of them stand at the top.
  function complain(errors) {
    for (const { words, note } of rowsOf.values()) {
      words.textContent = "";
      note.hidden = true;
    }
    for (const { node } of cells.values()) for (const key of ["aria-invalid", "aria-describedby"]) node.removeAttribute(key);
    replace(said, errors.map((error) => el("li", {}, error.message)));
    const named = entries(values?.cases).map((one, i) => [`case '${one?.name ?? `case ${i + 1}`}'`, `case ${i}`]);
    for (const { field: where, message } of errors) {
      const alias = named.find(([head]) => where.startsWith(head)) ?? (/^case\b/.test(where) ? named.find(([head]) => message.includes(head.slice(5))) : null);
      const key = alias ? alias[1] : [...rowsOf.keys()].find((one) => where === one || where.startsWith(`${one}.`) || where.startsWith(`${one}[`));
      const place = rowsOf.get(key);
      if (!place) continue;
      place.words.textContent = `${place.words.textContent} ${message}`.trim();
      place.note.hidden = false;
      const part = where.replace(alias ? alias[0] : key, "").split(/[.[]/)[1];
      const inRow = place.note.previousSibling.querySelectorAll("input, select");
      for (const node of inRow) {
        if (part && !node.dataset.path.split(".").includes(part)) continue;
        node.setAttribute("aria-invalid", "true");
        node.setAttribute("aria-describedby", place.words.id);
      }
    }
  }

  const add = (key, words, value) => el("button", { type: "button", onclick: () => change([{ path: [key, entries(values?.[key]).length], value: value() }], "") }, words);
  const section = (title, ...content) => el("section", {}, el("h2", {}, title), ...content);
  const node = el(
    "div",
    { class: "carriage" },
    el("div", { class: "tools files" }, choice.node, el("label", {}, "File ", name), save, told),
    el("div", { class: "head" }, verdict, stage, said),
    el(
      "div",
      { class: "seen" },
      section("Forces of the rollers on their rails", el("div", { class: "tools" }, cases.node, el("span", { class: "key radial" }, "radial"), el("span", { class: "key axial" }, "axial")), picture.node, el("p", { class: "soft", id: "carriage-hint" }, "Drag a roller (circle) or a mass (diamond), or move it with the arrow keys: by 1 mm, with Shift by 10 mm. A pair with preload moves together. Beside each roller stand its radial and axial force in N; each kind of arrow has a scale of its own.")),
      section("Loads", loads, sentences),
    ),
    el(
      "div",
      { class: "set" },
      section("Masses", masses, el("div", { class: "tools" }, add("payloads", "Add a payload", () => NEW.payloads))),
      section("Rollers", rollers),
      section("Load cases", loadCases, el("div", { class: "tools" }, add("cases", "Add a load case", () => NEW.cases(entries(values?.cases).length + 1)))),
      el("p", { class: "soft" }, "Units may stand behind numbers: 2 m/s2, 1.5 m, 3 %, 2 deg. All else stands in the text: forces at points, stiffness, catalogue, duty, names of rollers."),
    ),
    el("div", { class: "lives" }, section("Lives and margins", lives)),
    el("div", { class: "file" }, section("Carriage file", el("p", { class: "soft" }, "Edit the text, the fields or the picture: each follows the others."), area)),
  );

  return {
    node,
    undo: turn(() => past, () => future),
    redo: turn(() => future, () => past),
    canUndo: () => past.length > 0,
    canRedo: () => future.length > 0,
    redraw: picture.redraw,
    async draw() {
      if (text && state.carriage === file) return picture.redraw();
      if (opening) return;
      opening = true;
      const wanted = state.carriage;
      await list();
      await open(wanted);
      if (!text) await open(""); // the address named a file that is not there
      opening = false;
    },
  };
}
