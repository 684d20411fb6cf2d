// The study on the bench: one state document, kept fresh, and edits of its manifest.

import { ApiError, get, post, put, remove } from "./api.js";
import { say } from "./messages.js";

class Bench extends EventTarget {
  session = null;
  study = null;
  run = null;
  #stream = null;
  #reloading = null;

  tell(kind, detail) {
    this.dispatchEvent(new CustomEvent(kind, { detail }));
  }

  async start() {
    this.session = await get("/api/session");
    if (this.session.study) await this.reload();
  }

  async reload() {
    this.#reloading ??= get("/api/study")
      .then((document) => this.#take(document))
      .finally(() => (this.#reloading = null));
    return this.#reloading;
  }

  #take(document) {
    const first = this.study?.name !== document.name;
    this.study = document;
    this.run = document.run ?? this.run;
    if (first) this.#listen();
    this.tell("study", { first });
    return document;
  }

  /** Follow what other windows and the run do. */
  #listen() {
    this.#stream?.close();
    this.#stream = new EventSource("/api/events");
    const on = (kind, then) => this.#stream.addEventListener(kind, (event) => then(JSON.parse(event.data)));
    on("study", ({ revision }) => revision !== this.study?.revision && this.reload().catch(() => {}));
    on("run", (run) => this.takeRun(run));
    on("corrections", (detail) => this.tell("corrections", detail));
    this.#stream.onerror = () => this.tell("link", { there: false });
    this.#stream.onopen = () => this.tell("link", { there: true });
  }

  takeRun(run) {
    const ended = this.run?.state === "running" && run.state !== "running";
    this.run = run;
    this.tell("run", run);
    if (ended || (run.state === "done" && !this.study.results?.fresh)) this.reload().catch(() => {});
  }

  async open(name) {
    this.#take(await post("/api/session/open", { name }));
  }

  async create(name, title) {
    this.#take(await post("/api/session/new", { name, title }));
  }

  async close() {
    this.#stream?.close();
    this.session = await post("/api/session/close");
    this.study = this.run = null;
    this.tell("study", { first: true });
  }

  take(document) {
    return this.#take(document);
  }

  /** Add or replace a table of the manifest; `number` for curves, `name` for all else. */
  putTable(kind, key, table) {
    return this.#edit(put, { kind, ...nameOrNumber(kind, key), table });
  }

  deleteTable(kind, key) {
    return this.#edit(remove, { kind, ...nameOrNumber(kind, key) });
  }

  // Another window may have changed the study: take its state, and say again what was asked if that concerned
  // another table than ours; else leave theirs standing and say so.
  async #edit(way, change) {
    const before = JSON.stringify(tableOf(this.study, change));
    try {
      return this.#take(await way("/api/study/table", { revision: this.study.revision, ...change }));
    } catch (error) {
      if (!(error instanceof ApiError) || error.status !== 409 || !error.body.revision) throw error;
      await this.reload();
      if (JSON.stringify(tableOf(this.study, change)) !== before) {
        say("Another window changed this entry just now. Its values are shown; enter yours again if they should stand.", { kind: "error" });
        return this.study;
      }
      return this.#take(await way("/api/study/table", { revision: this.study.revision, ...change }));
    }
  }
}

const nameOrNumber = (kind, key) => (kind === "curves" ? { number: key } : key === undefined ? {} : { name: key });

function tableOf(study, { kind, name, number }) {
  const list = study[kind];
  if (Array.isArray(list)) return list.find((entry) => (kind === "curves" ? entry.number === number : entry.name === name))?.table ?? null;
  return list ?? [study.title, study.description, study.poisson_ratio];
}

export const bench = new Bench();

export const who = () => localStorage.getItem("fingerpad.who") || bench.session?.who || "";
export const setWho = (name) => localStorage.setItem("fingerpad.who", name.trim());

/** Words for a flag or note, from the library. */
export function wordsFor(code) {
  const words = bench.study?.words ?? {};
  return words.flags?.[code] ?? words.photograph_flags?.[code] ?? words.range_notes?.[code] ?? code.replaceAll("_", " ");
}
