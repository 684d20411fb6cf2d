// The table of sequences: contact images with the force while they were taken.

import { h } from "../core/dom.js";
import { workspace } from "../core/workspace.js";
import { choose, number, synthetic } from "../parts/forms.js";
import { scaleChoice } from "../parts/scale_ways.js";
import { card, cell, row, statusChip, table } from "../parts/tables.js";

/** @param {import("./study_tables.js").StudyTables} tables @param {Sequence[]} sequences */
export function sequenceTable(tables, sequences) {
  return card(
    "Sequences",
    "contact images with force",
    null,
    table(
      "Sequences",
      ["Sequence", "Finger", "Wedge, °", "Force, frame rate", "Scale", "Status", ""],
      sequences.map((one) => sequenceRow(tables, one)),
    ),
  );
}

/** @param {import("./study_tables.js").StudyTables} tables @param {Sequence} one */
function sequenceRow(tables, one) {
  const set = (key) => (value) => tables.change("sequence", one.name, { [key]: value });
  const files = workspace.study.files.filter(({ kind }) => kind === "table").map(({ file }) => file);
  const force = [...new Set([one.force, ...files].filter(Boolean))];
  return row(
    cell(
      h("a", { href: `#/contacts/${encodeURIComponent(`sequence:${one.name}`)}` }, one.name),
      " ",
      synthetic(one.synthetic),
      one.frames && h("div.soft.number", `${one.frames} frames`),
    ),
    cell(
      choose({
        value: one.finger ?? "",
        options: workspace.study.fingers.map(({ name }) => name),
        label: `Finger of ${one.name}`,
        onset: set("finger"),
      }),
    ),
    cell(
      number({
        value: one.wedge_angle_deg,
        min: 0,
        max: 90,
        label: `Wedge angle of ${one.name}`,
        onset: set("wedge_angle_deg"),
      }),
    ),
    cell(
      choose({
        value: one.force ?? "",
        options: [["", "– select table –"], ...force.map((file) => [file, file.split("/").at(-1)])],
        label: `Force of ${one.name}`,
        onset: set("force"),
      }),
      h(
        "div.control.below",
        number({
          value: one.frames_per_second,
          min: 0,
          label: `Frames per second of ${one.name}`,
          onset: set("frames_per_second"),
        }),
        h("span.unit", "frames/s"),
      ),
    ),
    cell(
      scaleChoice({
        value: one.scale,
        words: one.scale_words,
        label: `Scale of ${one.name}`,
        onset: set("scale"),
      }),
    ),
    cell(statusChip(one)),
    cell(tables.removal("sequence", one.name, one.name, one.name)),
  );
}
