// What reviews of images show and hear: panes, keys, and the words and marks of thumbnails.

import { h, render, small } from "../core/dom.js";
import { ask } from "../core/messages.js";
import { short } from "../core/quantity.js";
import { describeCode, setWho, who } from "../core/workspace.js";
import { empty, field, head, text } from "../parts/forms.js";

/**
 * Marks of a thumbnail for what a person did: kind and text.
 *
 * @param {Partial<Pick<Answers["FrameEntry"], "corrected" | "accepted" | "rejected" | "interpolated">>} entry
 */
export function reviewMarks({ corrected, accepted, rejected, interpolated }) {
  return [
    corrected && !interpolated && ["corrected", "corrected"],
    accepted && ["accepted", "accepted"],
    rejected && ["rejected", `rejected: ${rejected}`],
    interpolated && ["interpolated", "interpolated between key frames"],
  ].filter(Boolean);
}

/** Show that there are no images to review yet. */
export const renderNone = (root, title, none, words) =>
  render(root, [
    head(title, ""),
    empty(none, words, h("a.button.primary", { href: "#/study" }, "Go to study")),
  ]);

/** The name saved with corrections; the browser remembers it. */
function whoButton() {
  const shown = small("", askName, { title: "Saved with each correction" });
  const show = () => render(shown, [h("span.soft", "Corrections by"), h("strong", who() || "…")]);
  async function askName() {
    const name = text({ value: who() });
    const body = field("Name or initials", name, { hint: "Saved with each correction." });
    if (await ask("Your name", body, "Save")) setWho(name.value);
    show();
  }
  show();
  return shown;
}

/**
 * The panes of a review.
 *
 * @param {import("./review.js").Review} view
 * @param {string} title
 * @param {string} words
 * @param {any} bar above the filmstrip
 */
export const panesOf = (view, title, words, bar) => [
  head(title, words, whoButton()),
  h("div.panes", [
    view.toolbar,
    view.stage.root,
    h("aside.inspector", { "aria-label": "Selected image", tabindex: 0 }, [
      view.inspector.root,
      view.inspector.footer,
    ]),
    h("section.filmstrip-panel", { "aria-label": "All images" }, [bar, view.strip.root]),
  ]),
];

/** The keys of all reviews, and those of one. @param {import("./review.js").Review} view */
export const keysOf = (view, own) => [
  ["Enter", "Accept, next image", () => view.accept()],
  ["ArrowRight .", "Next image", () => view.step(1)],
  ["ArrowLeft ,", "Previous image", () => view.step(-1)],
  ["x", "Reject, or undo the rejection", () => view.reject()],
  ["u Ctrl+z", "Undo", () => view.undo()],
  ["r Ctrl+y Ctrl+Z", "Redo", () => view.redo()],
  ...view.tools.map(([tool, words, key, help]) => [key, help ?? words, () => view.use(tool)]),
  ...own,
  [
    "[ ]",
    "Smaller or larger brush",
    ({ key }) => view.setRadius(key === "]" ? view.radius * 1.25 + 0.5 : view.radius * 0.8 - 0.5),
  ],
  ["+ - 0", "Zoom in, zoom out, fit the image", null],
  ["Tab", "Select a handle; arrow keys move it, Shift ×10, Alt ×⅕", null],
  ["Space", "Use the tool at the cross-hair", null],
];

/** Which entries are shown, by what is chosen. @type {Record<string, (entry: any) => boolean>} */
export const FILTERS = {
  all: () => true,
  "not reviewed": (entry) => !entry.accepted && !entry.rejected && entry.status !== "none",
  flagged: (entry) => entry.flags?.length > 0,
  corrected: (entry) => entry.corrected,
  rejected: (entry) => Boolean(entry.rejected),
};

/**
 * @param {Partial<Omit<Observation, "status" | "file"> & Frame>} entry
 * @param {{ named?: boolean }} [options] whether the finger is named
 */
export function describeContact(entry, { named = false } = {}) {
  const framed = entry.frame !== undefined;
  const state = entry.rejected ? "rejected" : entry.status;
  const marks = [];
  if (entry.flags?.length) marks.push(["flag", entry.flags.map(describeCode).join("; ")]);
  if (entry.status === "failed") marks.push(["failed", entry.reason ?? "failed"]);
  marks.push(...reviewMarks(entry));
  const load = (entry.load_N ?? null) === null ? "" : `${short(entry.load_N, 3)} N`;
  const finger = named && entry.finger;
  return {
    above: finger,
    label: framed
      ? `${entry.frame}${load ? ` · ${load}` : ""}`
      : load
        ? `${load} · ${entry.wedge_angle_deg}°`
        : entry.item,
    name: [
      framed ? `Frame ${entry.frame}` : entry.item,
      finger,
      load,
      ...marks.map(([, title]) => title),
      state === "none" ? "no contact found, or not run yet" : "",
    ]
      .filter(Boolean)
      .join(", "),
    state,
    marks,
  };
}
