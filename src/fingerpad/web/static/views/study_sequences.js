// The table of sequences: contact images with the force while they were taken.

import { h } from "../core/dom.js";
import { workspace } from "../core/workspace.js";
import { choose, number, synthetic } from "../parts/forms.js";
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
  const cells = tables.cells("sequence", one.name, one);
  const files = workspace.study.files.filter(({ kind }) => kind === "table").map(({ file }) => file);
  const force = [...new Set([one.force, ...files].filter(Boolean))];
  return row(
    cell(
      h("a", { href: `#/contacts/${encodeURIComponent(`sequence:${one.name}`)}` }, one.name),
      " ",
      synthetic(one.synthetic),
      one.frames && h("div.soft.number", `${one.frames} frames`),
    ),
    cells.finger(),
    cells.number("wedge_angle_deg", "Wedge angle", { max: 90 }),
    cell(
      choose({
        value: one.force ?? "",
        options: [["", "– select table –"], ...force.map((file) => [file, file.split("/").at(-1)])],
        label: `Force of ${one.name}`,
        onset: cells.set("force"),
      }),
      h(
        "div.control.below",
        number({
          value: one.frames_per_second,
          min: 0,
          label: `Frames per second of ${one.name}`,
          onset: cells.set("frames_per_second"),
        }),
        h("span.unit", "frames/s"),
      ),
    ),
    cells.scale(),
    cell(statusChip(one)),
    cell(tables.removal("sequence", one.name, one.name, one.name)),
  );
}
