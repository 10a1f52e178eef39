// The case on the screen, the pinned variants, undo, and all of it in the address.
const MOST_PINS = 8;
const PIN = "pin";

export function createState() {
  const listeners = new Set();
  const past = [];
  const future = [];
  let held = null; // the case before a slider began to move
  const state = {
    values: {},
    pins: [],
    tab: "roller",
    carriage: "", // the file of the folder that the tab Carriage shows
    onChange: (listener) => listeners.add(listener),
  };
  const tell = (what) => listeners.forEach((listener) => listener(what));

  function keep(values) {
    past.push(values);
    future.length = 0;
    if (past.length > 200) past.shift();
  }

  // `moving` joins the steps of one movement into one step of undo.
  state.change = (changes, moving = false) => {
    if (moving) held ??= { ...state.values };
    else {
      keep(held ?? { ...state.values });
      held = null;
    }
    for (const [name, value] of Object.entries(changes)) {
      if (value === null || value === "") delete state.values[name];
      else state.values[name] = value;
    }
    tell(moving ? "moving" : "case");
  };
  state.replace = (values) => {
    keep({ ...state.values });
    state.values = { ...values };
    tell("case");
  };
  const step = (from, to) => () => {
    if (!from.length) return;
    to.push({ ...state.values });
    state.values = from.pop();
    tell("case");
  };
  state.undo = step(past, future);
  state.redo = step(future, past);
  state.canUndo = () => past.length > 0;
  state.canRedo = () => future.length > 0;

  state.pin = () => {
    if (state.pins.length >= MOST_PINS) return false;
    state.pins.push({ ...state.values });
    tell("pins");
    return true;
  };
  state.unpin = (i) => {
    state.pins.splice(i, 1);
    tell("pins");
  };
  state.show = (tab) => {
    state.tab = tab;
    tell("tab");
  };

  // The address of the sheet or workbook of the roller on the screen.
  state.file = (name) => `${name}?case=${encodeURIComponent(JSON.stringify(state.values))}`;

  state.written = () => {
    const found = new URLSearchParams(Object.entries(state.values));
    if (state.tab !== "roller" || ![...found].length) found.set("tab", state.tab); // an empty address is the first example
    if (state.carriage) found.set("carriage", state.carriage);
    for (const pin of state.pins) found.append(PIN, new URLSearchParams(Object.entries(pin)));
    return found.toString();
  };
  state.read = (hash) => {
    const found = new URLSearchParams(hash.replace(/^#/, ""));
    state.tab = found.get("tab") ?? "roller";
    state.carriage = found.get("carriage") ?? "";
    state.pins = found.getAll(PIN).slice(0, MOST_PINS).map((text) => Object.fromEntries(new URLSearchParams(text)));
    state.values = Object.fromEntries([...found].filter(([name]) => ![PIN, "tab", "carriage"].includes(name)));
    tell("case");
    tell("pins");
    tell("tab");
  };
  return state;
}
