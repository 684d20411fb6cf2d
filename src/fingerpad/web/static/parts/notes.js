// Notes about what is entered: what looks wrong, and semi-axes of the last run that are out of date.

import { h } from "../core/dom.js";
import { workspace } from "../core/workspace.js";
import { chip } from "./forms.js";

const CHANGED = "photographs, their scale or their corrections have changed since the last run";

const isStale = ({ status, semi_axes_mm: axes }) => status === "stale" && axes !== null;

/**
 * A mark beside semi-axes of a finger, or a radius from them; nothing where they are up to date.
 *
 * @param {string | null | undefined} name
 */
export function staleChip(name, words = "of the last run, out of date") {
  const finger = workspace.study.fingers.find((each) => each.name === name);
  return finger && isStale(finger) && chip(words, "warn", `Semi-axes of ${name}: ${CHANGED}.`);
}

/** Notes about fingers whose semi-axes are out of date, or have none after the last run. */
export const axesNotes = () =>
  workspace.study.fingers
    .filter(({ status }) => status === "stale" || status === "failed")
    .map(({ name, status, reason }) =>
      h("div.note", [
        status === "failed"
          ? [h("strong", "No semi-axes in the last run: "), `${reason}.`]
          : [h("strong", `Semi-axes of ${name} are out of date. `), `Its ${CHANGED}; run the study again.`],
      ]),
    );

/** Notes about values of the manifest that look as if they were meant otherwise, as full widths. */
export const doubtNotes = (name = "div.note") => workspace.study.doubts.map((words) => h(name, `${words}.`));
