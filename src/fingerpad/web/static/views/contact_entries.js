// Labels and filters of the filmstrip of contact images.

import { short } from "../core/quantity.js";
import { describeCode } from "../core/workspace.js";
import { reviewMarks } from "./review_layout.js";

export const FILTERS = [["", "all"], ["todo", "not reviewed"], "flagged", "corrected", "rejected"];

export const FILTER_TESTS = {
  "": () => true,
  todo: (entry) => !entry.accepted && !entry.rejected && entry.status !== "none",
  flagged: (entry) => entry.flags?.length > 0,
  corrected: (entry) => entry.corrected,
  rejected: (entry) => Boolean(entry.rejected),
};

/**
 * @param {Partial<Omit<Observation, "status" | "file"> & Frame>} entry
 * @param {{ named?: boolean }} [options] whether the finger is named
 */
export function describe(entry, { named = false } = {}) {
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
