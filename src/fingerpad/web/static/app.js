// The page: steps in the sidebar, and the view of the current step.

import { h, render } from "./core/dom.js";
import { explain } from "./core/glossary.js";
import { bindEverywhere, bindHere, listen, showHelp } from "./core/keys.js";
import { showError } from "./core/messages.js";
import { drawSidebar } from "./core/sidebar.js";
import { workspace } from "./core/workspace.js";
import * as contacts from "./views/contacts.js";
import * as pad from "./views/pad.js";
import * as photographs from "./views/photographs.js";
import * as results from "./views/results.js";
import * as run from "./views/run.js";
import * as scale from "./views/scale.js";
import * as study from "./views/study.js";
import * as welcome from "./views/welcome.js";

/** @type {[key: string, title: string, view: { open(root: Element, rest: string[]): View }][]} */
export const STEPS = [
  ["study", "Study", study],
  ["scale", "Scale", scale],
  ["photographs", "Photographs", photographs],
  ["contacts", "Contacts", contacts],
  ["pad", "Pad", pad],
  ["run", "Run & export", run],
  ["results", "Results", results],
];

const work = document.getElementById("work");
/** @type {View | null} */
let open = null;
let openName = null;

function route() {
  const [name, ...rest] = location.hash.replace(/^#\/?/, "").split("/").map(decoded);
  return { name: STEPS.some(([key]) => key === name) ? name : "study", rest };
}

/** A part of an address; one that was typed may have a bare percent sign. */
function decoded(part) {
  try {
    return decodeURIComponent(part);
  } catch {
    return part;
  }
}

function show({ fresh = false } = {}) {
  const { name, rest } = route();
  const wanted = workspace.study ? name : "welcome";
  // A view that can show the rest of the address is kept.
  if (fresh || wanted !== openName || !open?.navigate?.(rest)) {
    open?.close?.();
    bindHere([]);
    openName = wanted;
    work.className = `view-${wanted}`;
    render(work);
    const view = wanted === "welcome" ? welcome : STEPS.find(([key]) => key === wanted)[2];
    open = view.open(work, rest);
    document.title = workspace.study
      ? `${STEPS.find(([key]) => key === name)[1]} – ${workspace.study.title || workspace.study.name}`
      : "fingerpad";
  }
  drawSidebar(wanted, STEPS);
}

function failed(error) {
  render(work, [
    h("div.empty", { role: "alert" }, [
      h("h1", "The page cannot be loaded"),
      h("p", error.message),
      error.status === 403 && h("p", "Open the complete address that the terminal shows."),
      h("div.actions", [
        h("button.primary", { type: "button", onclick: () => location.reload() }, "Try again"),
      ]),
    ]),
  ]);
}

bindEverywhere(
  ...STEPS.map(([key, words], index) => [String(index + 1), words, () => (location.hash = `#/${key}`)]),
  ["?", "Show the keys", () => showHelp()],
  ["Escape", "Leave a field or a handle", () => /** @type {HTMLElement} */ (document.activeElement)?.blur()],
);

listen();
explain();
window.addEventListener("hashchange", () => show());
window.addEventListener("unhandledrejection", (event) => {
  event.preventDefault();
  showError(event.reason);
});
workspace.on("study", (detail) => {
  if (detail.first || !open) show({ fresh: true });
  else {
    open.update?.();
    drawSidebar(openName, STEPS);
  }
});
workspace.on("run", () => drawSidebar(openName, STEPS));
workspace.on("link", ({ problem }) => {
  const banner = document.getElementById("link");
  document.body.classList.toggle("cut", Boolean(problem));
  banner.hidden = !problem;
  if (banner.textContent !== problem) banner.textContent = problem;
});

workspace.start().then(() => openName ?? show({ fresh: true }), failed);
