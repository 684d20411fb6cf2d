// The open study: its state, kept up to date, and edits of its manifest.

import { ApiError, addressOf, context, get, post } from "./api.js";
import { clearMessages, showError, toast } from "./messages.js";

// The study of this window, empty after it was left; kept over a reload.
const OPEN = "fingerpad.study";

// How often a server that is gone is asked for.
const SEEK_MS = 3000;
const GONE =
  "fingerpad does not respond. Confirmed changes are saved; others are not. Start it again with “fingerpad " +
  "app” and use the page that opens; on the same port, this one then goes on.";
const RESTARTED =
  "fingerpad was started again: open the address that it printed in the terminal. This page then goes on.";

class Workspace extends EventTarget {
  /** @type {Answers["Session"] | null} */
  session = null;
  /** @type {State | null} */
  study = null;
  /** @type {Answers["RunStatus"] | null} */
  run = null;
  /** @type {EventSource | null} */
  #stream = null;
  #reloading = null;
  #version = 0;
  #reloadTimer = null;
  #linkTimer = null;
  /** @type {Promise<any>} */
  #editing = Promise.resolve();

  /** @param {string} kind @param {any} [detail] */
  emit(kind, detail) {
    this.dispatchEvent(new CustomEvent(kind, { detail }));
  }

  /**
   * Call a listener with the detail of each event of a kind; the function returned removes it.
   *
   * @param {string} kind
   * @param {(detail: any) => void} listener
   */
  on(kind, listener) {
    const handler = (event) => listener(event.detail);
    this.addEventListener(kind, handler);
    return () => this.removeEventListener(kind, handler);
  }

  async start() {
    this.session = await get("/api/session");
    const named = new URLSearchParams(location.search).get("study");
    const name = named ?? sessionStorage.getItem(OPEN) ?? this.session.study?.name;
    if (!name) return;
    context.study = name;
    try {
      await this.reload();
    } catch (error) {
      if (!(error instanceof ApiError) || error.status !== 404) throw error;
      this.#leave(); // moved or removed since
      sessionStorage.removeItem(OPEN);
      if (named) showError(error);
    }
  }

  /** Load a state that is not older than this call. */
  reload() {
    this.#version += 1;
    return (this.#reloading ??= this.#read().finally(() => (this.#reloading = null)));
  }

  /** Load the state again if it changed while it was loaded. */
  async #read() {
    let document, known;
    do {
      known = this.#version;
      document = await get("/state");
      if (context.study === null) return null; // left meanwhile
    } while (known !== this.#version);
    return this.take(document);
  }

  /** Leave the study. */
  #leave() {
    this.#stream?.close();
    clearTimeout(this.#reloadTimer);
    this.#version += 1;
    this.study = this.run = context.study = null;
    this.#linked();
    clearMessages();
    // Without an event, upon which the start page would be drawn twice, and a click between the two be lost.
    history.replaceState(null, "", `${location.pathname}#/study`);
  }

  /** Take the state of the study, or of one to open. @param {State} document */
  take(document) {
    this.#version += 1;
    context.study = document.name;
    sessionStorage.setItem(OPEN, document.name);
    const first = this.study?.name !== document.name;
    // The address names the study, so that it opens the same view elsewhere too.
    const query = `?study=${encodeURIComponent(document.name)}`;
    if (location.search !== query) history.replaceState(null, "", query + location.hash);
    // Unused files are listed as files, not as missing entries.
    const missing = document.missing.filter(({ kind }) => kind !== "file");
    this.study = { ...document, missing };
    if (first) {
      this.run = null;
      clearMessages(); // of another study
      this.#listen();
    }
    this.#updateRun(document.run);
    this.emit("study", { first });
    return document;
  }

  /** Listen to other windows and to the run. */
  #listen() {
    this.#stream?.close();
    this.#stream = new EventSource(addressOf("/events"));
    const on = (kind, then) => this.#stream.addEventListener(kind, (event) => then(JSON.parse(event.data)));
    on("study", ({ digest }) => digest !== this.study?.digest && this.reload().catch(() => {}));
    on("run", (run) => this.takeRun(run));
    on("corrections", (detail) => {
      this.emit("corrections", detail);
      // The state of the whole study is reloaded once corrections pause.
      clearTimeout(this.#reloadTimer);
      this.#reloadTimer = setTimeout(() => this.reload().catch(() => {}), 1500);
    });
    // It is asked for once, however often the stream fails.
    this.#stream.onerror = () => this.#linkTimer === null && this.#seek();
    this.#stream.onopen = () => this.#linked();
  }

  #linked() {
    clearTimeout(this.#linkTimer);
    this.#linkTimer = null;
    this.emit("link", { problem: "" });
  }

  /** Say that the server is gone, and ask for it until it is back. */
  async #seek() {
    this.#linkTimer = setTimeout(() => this.#seek(), SEEK_MS);
    try {
      const session = await get("/api/session");
      if (!this.#linkTimer) return; // found, or the study left, meanwhile
      this.session = session;
      this.#linked();
      this.#listen();
      await this.reload();
    } catch (error) {
      if (this.#linkTimer) this.emit("link", { problem: error.status === 403 ? RESTARTED : GONE });
    }
  }

  /** Update the status of the run unless a later one is known. */
  #updateRun(run) {
    if (run.version < this.run?.version) return false;
    this.run = run;
    return true;
  }

  /** @param {Answers["RunStatus"]} run */
  takeRun(run) {
    const ended = this.run?.state === "running" && run.state !== "running";
    if (!this.#updateRun(run)) return;
    this.emit("run", run);
    if (ended || (run.state === "done" && !this.study.results?.fresh)) this.reload().catch(() => {});
  }

  /** Leave the study: it stays open for other windows, and its run goes on. */
  async close() {
    this.session = await get("/api/session");
    this.#leave();
    sessionStorage.setItem(OPEN, "");
    this.emit("study", { first: true });
  }

  /**
   * Change the manifest by all edits or none, one call after the other. If another window changed the study
   * just before, the edits are sent again unless they are about the same tables.
   *
   * @param {...Edit} edits
   */
  edit(...edits) {
    const { name } = this.study;
    const mine = this.#editing.then(() => {
      if (this.study?.name !== name)
        throw new ApiError(409, { error: `The study ${name} is no longer open; the change was not saved.` });
      return this.#edit(edits);
    });
    this.#editing = mine.catch(() => {});
    return mine;
  }

  /** @param {Edit[]} edits */
  async #edit(edits) {
    const send = async () => this.take(await post("/edits", { expected: this.study.digest, edits }));
    const before = edits.map((edit) => tableOf(this.study, edit));
    try {
      return await send();
    } catch (error) {
      if (!(error instanceof ApiError) || error.status !== 409) throw error;
      await this.reload();
      if (!this.study) return null; // left meanwhile
      if (edits.some((edit, index) => tableOf(this.study, edit) !== before[index])) {
        toast(
          "Another window changed this entry just now. Its values are shown; enter yours again if needed.",
          { kind: "error" },
        );
        return this.study;
      }
      return send();
    }
  }
}

/**
 * The state of the table that an edit changes, as text to compare.
 *
 * @param {State} study
 * @param {Edit} edit
 */
function tableOf(study, { kind, key }) {
  if (kind === "study")
    return JSON.stringify([study.title, study.description, study.poisson_ratio, study.surface]);
  if (kind === "uncertainty" || kind === "apparatus") return JSON.stringify(study[kind]);
  if (kind === "photograph")
    return JSON.stringify(
      study.fingers.flatMap(({ photographs }) => photographs).find(({ item }) => item === key) ?? null,
    );
  /** @type {any[]} */
  const tables = study[`${kind}s`];
  const found = tables.find((entry) => (entry.item ?? entry.key ?? entry.name) === key);
  return JSON.stringify(found ?? null);
}

export const workspace = new Workspace();

/** What can be entered, by the library's rules. */
export const rules = () => workspace.session.rules;

export const who = () => localStorage.getItem("fingerpad.who") || workspace.session?.who || "";
export const setWho = (name) => localStorage.setItem("fingerpad.who", name.trim());

const CONTACT_FLAGS = ["contact", "scale", "frame", "row", "layer"];
export const PHOTOGRAPH_FLAGS = ["photograph", "scale"];

/** What a flag or note means, and what to do about it, of the first kinds of things flagged that know it. */
function flagOf(code, kinds) {
  const flags = workspace.study?.flags;
  return kinds.map((kind) => flags?.[kind]?.[code]).find(Boolean);
}

/** Description of a flag or note of a contact. */
export const describeCode = (code) => flagOf(code, CONTACT_FLAGS)?.words ?? code.replaceAll("_", " ");

/** Description of a flag or note, and what to do about it. */
export function adviseCode(code, kinds = CONTACT_FLAGS) {
  const flag = flagOf(code, kinds);
  return flag ? `${sentence(flag.words)}. To do: ${flag.to_do}.` : code.replaceAll("_", " ");
}

const sentence = (text) => text[0].toUpperCase() + text.slice(1);
