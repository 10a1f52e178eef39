// Questions to the server. The page lies below the token, so that every address is relative.
const page = crypto.getRandomValues(new Uint32Array(2)).join("-");

// What the server refuses: `errors` holds a field and a message each.
export class Refused extends Error {
  constructor(errors) {
    super(errors.map((error) => error.message).join(" "));
    this.errors = errors;
  }
}

// Of questions with the same name and slot the server answers the newest only.
export async function ask(name, body = {}, slot = "") {
  let answer;
  try {
    answer = await fetch(`api/${name}`, {
      method: "POST",
      headers: { "Content-Type": "application/json" },
      body: JSON.stringify({ ...body, page: `${page} ${slot}` }),
    });
  } catch {
    throw new Refused([{ field: "", message: "The server does not answer. Start it again: trackroller app" }]);
  }
  const found = await answer.json();
  if (found.stale) return new Promise(() => {}); // a newer question of this slot gets the answer
  if (!answer.ok) throw new Refused(found.errors ?? [{ field: "", message: "The server refused." }]);
  return found;
}
