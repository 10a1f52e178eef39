// One request at a time: while a slider moves, `preview` of the newest case; when it rests, `standard`, and then the
// distances to lift-off, slip and self-locking. What a newer case has overtaken is never asked for.
import { ask } from "./api.js";

const REST = 150; // ms without a change until `standard` is solved
const LATER = 250; // ms after it until the distances are searched, which takes longest
const WORN = 1000; // ms instead if the profiles wear over a travel first, whose steps take seconds

export function live({ values, inside, shown, failed }) {
  let version = 0; // of the case
  let wish = null;
  let busy = false;
  let timer = 0;

  async function work() {
    if (busy || !wish) return;
    const own = wish;
    wish = null;
    busy = true;
    try {
      const picture = await ask("picture", { values: own.values, accuracy: own.accuracy, complete: own.complete, inside: own.inside });
      if (own.version === version || own.accuracy === "preview") shown(picture, own);
    } catch (error) {
      if (own.version === version) failed(error.errors ?? [{ field: "", message: String(error) }]);
      if (!error.errors) console.error(error);
    }
    busy = false;
    if (own.version === version && !wish) {
      if (own.accuracy === "preview") later(REST - (performance.now() - own.at), { accuracy: "standard", inside: inside() });
      else if (!own.complete) later(own.unworn ? WORN : LATER, { accuracy: "standard", complete: true, inside: inside() });
    }
    work();
  }

  function later(delay, more) {
    const own = version;
    clearTimeout(timer);
    timer = setTimeout(() => own === version && want(more), Math.max(0, delay));
  }

  function want(more) {
    const { travel, ...unworn } = values();
    const before = travel !== undefined && !more.complete;
    wish = { values: before ? unworn : { ...values() }, unworn: before, version, at: performance.now(), accuracy: "preview", complete: false, inside: false, ...more };
    work();
  }

  return {
    changed() {
      version += 1;
      clearTimeout(timer);
      want({});
    },
    again: () => want({ accuracy: "standard", inside: inside() }),
  };
}
