// Symbols, each explained where it stands by the library's glossary: on hover, on focus and by touch.

import { h, render } from "./dom.js";
import { workspace } from "./workspace.js";

const ROOM = 8;

/** @type {any} */
let shown = null;
const tip = h("div.term-tip", { id: "term-tip", role: "tooltip", hidden: true });

const meaningOf = (key) => workspace.session?.glossary[key];

const titleOf = ({ name, unit }) => [name, unit].filter(Boolean).join(", ");

/** The letters of a symbol, with subscripts and superscripts. @param {string} key */
export const symbolParts = (key) =>
  key.split(/(?=[_^/])/).map((part) => {
    if (part[0] === "_") return h("sub", part.slice(1));
    if (part[0] === "^") return h("sup", part.slice(1));
    if (part[0] === "/") return ["/", h("i", part.slice(1))];
    return h("i", part);
  });

/**
 * A symbol as in the glossary: symbol("R_0g"), symbol("R_g^corr"), symbol("ℓ_d/ℓ_e"). In a control, which
 * has the focus itself, it takes none.
 *
 * @param {string} key
 * @param {{ inControl?: boolean, words?: any }} [options] words to show in place of the symbol
 */
export function symbol(key, { inControl = false, words } = {}) {
  const known = meaningOf(key);
  return h(
    "abbr.symbol",
    {
      "data-term": known && key,
      tabindex: known && !inControl ? 0 : undefined,
      "aria-description": known && `${titleOf(known)}: ${known.meaning}.`,
    },
    words ?? symbolParts(key),
  );
}

function show(term) {
  shown = term;
  const known = meaningOf(term.dataset.term);
  const { meaning, column } = known;
  render(tip, [h("strong", titleOf(known)), h("span", `${meaning}.`), column && h("code", column)]);
  // In an open dialog, which is above everything else.
  (term.closest("dialog") ?? document.body).append(tip);
  tip.hidden = false;
  const at = term.getBoundingClientRect();
  const { offsetWidth: width, offsetHeight: height } = tip;
  const below = at.bottom + ROOM + height < innerHeight;
  tip.style.left = `${Math.max(ROOM, Math.min(at.left, innerWidth - width - ROOM))}px`;
  tip.style.top = `${below ? at.bottom + ROOM : Math.max(ROOM, at.top - height - ROOM)}px`;
}

function hide() {
  tip.hidden = true;
  shown = null;
}

/** The term of an event's target, or of the control around it. */
const termOf = ({ target }) =>
  target.closest?.("[data-term]") ??
  target.closest?.("button, summary, label")?.querySelector("[data-term]") ??
  null;

/** Explain symbols from now on. */
export function explain() {
  document.body.append(tip);
  for (const kind of ["pointerover", "focusin", "click"])
    document.addEventListener(kind, (event) => {
      const term = termOf(event);
      if (term) show(term);
      else if (shown) hide();
    });
  document.addEventListener("focusout", () => shown && hide());
  document.addEventListener("scroll", () => shown && hide(), true);
  document.addEventListener("keydown", (event) => event.key === "Escape" && shown && hide());
}
