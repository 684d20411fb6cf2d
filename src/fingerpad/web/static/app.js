// The page: steps in the sidebar, and the view of the current step.

import { button, h, render } from "./core/dom.js";
import { explain } from "./core/glossary.js";
import { bindEverywhere, bindHere, listen, showHelp } from "./core/keys.js";
import { showError } from "./core/messages.js";
import { drawSidebar } from "./core/sidebar.js";
import { workspace } from "./core/workspace.js";
import { prepareCharts } from "./parts/chart.js";
import { Contacts } from "./views/contacts.js";
import { PadView } from "./views/pad.js";
import { Photographs } from "./views/photographs.js";
import { Results } from "./views/results.js";
import { Run } from "./views/run.js";
import { Scales } from "./views/scale.js";
import { StudyView } from "./views/study.js";
import { Welcome } from "./views/welcome.js";

/** @type {[key: string, title: string, view: new (root: Element, rest: string[]) => View][]} */
export const STEPS = [
  ["study", "Study", StudyView],
  ["scale", "Scale", Scales],
  ["photographs", "Photographs", Photographs],
  ["contacts", "Contacts", Contacts],
  ["pad", "Pad", PadView],
  ["run", "Run & export", Run],
  ["results", "Results", Results],
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
    const [, title, Step] = STEPS.find(([key]) => key === name);
    open = workspace.study ? new Step(work, rest) : /** @type {any} */ (new Welcome(work));
    document.title = workspace.study
      ? `${title} – ${workspace.study.title || workspace.study.name}`
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
      h("div.actions", [button("Try again", () => location.reload(), { kind: "primary" })]),
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
// Where no view takes a dropped file, the browser would show it in place of the page.
for (const type of ["dragover", "drop"])
  window.addEventListener(type, (event) => {
    if (/** @type {DragEvent} */ (event).dataTransfer?.types.includes("Files")) event.preventDefault();
  });
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
  // While another view is looked at.
  if (workspace.study?.results.there) (window.requestIdleCallback ?? setTimeout)(prepareCharts);
});
for (const kind of ["run", "theme"]) workspace.on(kind, () => drawSidebar(openName, STEPS));
workspace.on("link", ({ problem }) => {
  const banner = document.getElementById("link");
  document.body.classList.toggle("cut", Boolean(problem));
  banner.hidden = !problem;
  if (banner.textContent !== problem) banner.textContent = problem;
});

workspace.start().then(() => openName ?? show({ fresh: true }), failed);
