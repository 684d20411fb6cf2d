// The page: the steps of the work on the left, the step that is open on the right.

import { h, place } from "./core/dom.js";
import { bindEverywhere, bindHere, listen, showHelp } from "./core/keys.js";
import { complain } from "./core/messages.js";
import { drawRail } from "./core/sidebar.js";
import { bench } from "./core/workspace.js";
import * as contacts from "./views/contacts.js";
import * as pad from "./views/pad.js";
import * as photographs from "./views/photographs.js";
import * as results from "./views/results.js";
import * as run from "./views/run.js";
import * as scale from "./views/scale.js";
import * as study from "./views/study.js";
import * as welcome from "./views/welcome.js";

export const STEPS = [
  ["study", "Study", study],
  ["scale", "Scale", scale],
  ["photographs", "Photographs", photographs],
  ["contacts", "Contacts", contacts],
  ["pad", "Pad", pad],
  ["results", "Results", results],
  ["run", "Run & export", run],
];

const work = document.getElementById("work");
let open = null;
let openName = null;

function route() {
  const [name, ...rest] = decodeURI(location.hash).replace(/^#\/?/, "").split("/");
  return { name: STEPS.some(([key]) => key === name) ? name : "study", rest: rest.map(decodeURIComponent) };
}

function show({ fresh = false } = {}) {
  const { name, rest } = route();
  const wanted = bench.study ? name : "welcome";
  // A view that can turn to what is wanted need not be opened anew.
  if (fresh || wanted !== openName || !open?.turn?.(rest)) {
    open?.close?.();
    bindHere([]);
    openName = wanted;
    work.className = `view-${wanted}`;
    place(work);
    const view = wanted === "welcome" ? welcome : STEPS.find(([key]) => key === wanted)[2];
    open = view.open(work, rest);
    document.title = bench.study
      ? `${STEPS.find(([key]) => key === name)[1]} – ${bench.study.title || bench.study.name}`
      : "fingerpad";
  }
  drawRail(wanted, STEPS);
}

function failed(error) {
  place(
    work,
    h(
      "div.empty",
      { role: "alert" },
      h("h1", null, "The bench cannot be opened"),
      h("p", null, error.message),
      error.status === 403 &&
        h(
          "p",
          null,
          "This page was opened without the launch's own address. Copy the whole address that the terminal shows.",
        ),
      h(
        "div.actions",
        null,
        h("button.primary", { type: "button", onclick: () => location.reload() }, "Try again"),
      ),
    ),
  );
}

bindEverywhere(
  ...STEPS.map(([key, words], index) => [String(index + 1), words, () => (location.hash = `#/${key}`)]),
  ["?", "These keys", () => showHelp()],
  ["Escape", "Let go of a field or a mark", () => document.activeElement?.blur()],
);

listen();
window.addEventListener("hashchange", () => show());
window.addEventListener("unhandledrejection", (event) => {
  event.preventDefault();
  complain(event.reason);
});
bench.addEventListener("study", ({ detail }) => {
  if (detail.first || !open) show({ fresh: true });
  else {
    open.update?.();
    drawRail(openName, STEPS);
  }
});
bench.addEventListener("run", () => drawRail(openName, STEPS));
bench.addEventListener("link", ({ detail }) => document.body.classList.toggle("cut", !detail.there));

bench.start().then(() => openName ?? show({ fresh: true }), failed);
