// Keyboard shortcuts: each view binds its own, and the help dialog lists them.

import { button, h } from "./dom.js";
import { openDialog } from "./messages.js";

const everywhere = [];
let here = [];

/** Bind keys on all views: [keys, description, action]. */
export const bindEverywhere = (...keys) => everywhere.push(...keys);

/** Bind keys of the current view. */
export const bindHere = (keys) => (here = keys);

const typing = (target) =>
  target.closest?.(
    "input:not([type=checkbox]):not([type=radio]):not([type=range]), textarea, select, [contenteditable]",
  );

export function nameOf(event) {
  const key = event.key === " " ? "Space" : event.key;
  return (
    (event.ctrlKey || event.metaKey ? "Ctrl+" : "") + (event.shiftKey && key.length > 1 ? "Shift+" : "") + key
  );
}

/** Keys that go to another image, change an angle, or make a brush larger. */
const MOVING = /Arrow|^[.,[\]wW]$/;

export function listen() {
  document.addEventListener("keydown", (event) => {
    if (event.defaultPrevented || event.altKey || document.querySelector("dialog[open]")) return;
    const name = nameOf(event);
    // A key that is held goes on moving, but saves nothing again.
    if (event.repeat && !MOVING.test(name)) return;
    // Arrow keys on a slider move it.
    if (/** @type {Element} */ (event.target).matches?.("input[type=range]") && /^Arrow|Home|End/.test(name))
      return;
    if (typing(event.target) && !["Escape", "Ctrl+Enter"].includes(name)) return;
    if (
      (name === "Enter" || name === "Space") &&
      /** @type {Element} */ (event.target).closest("button, a, summary, [role=tab], input")
    )
      return;
    for (const [keys, , action] of [...here, ...everywhere]) {
      if (action && keys.split(" ").includes(name)) {
        if (action(event) !== false) event.preventDefault();
        return;
      }
    }
  });
}

const SIGNS = { ArrowLeft: "←", ArrowRight: "→", ArrowUp: "↑", ArrowDown: "↓", Escape: "Esc" };
const shownAs = (key) => SIGNS[key] ?? key;

function table(title, keys) {
  return h("section", [
    h("h3", title),
    h("dl.keys", [
      keys.map(([names, words]) => [
        h("dt", [names.split(" ").map((name) => h("kbd", name.replace(/[A-Z][a-zA-Z]+/, shownAs)))]),
        h("dd", words),
      ]),
    ]),
  ]);
}

export function showHelp() {
  const dialog = h("dialog.help", { "aria-label": "Keys" }, [
    h("header", [h("h2", "Keys"), button("Close", () => dialog.close(), { autofocus: true })]),
    h("div.columns", [here.length > 0 && table("This step", here), table("Everywhere", everywhere)]),
  ]);
  openDialog(dialog);
}
