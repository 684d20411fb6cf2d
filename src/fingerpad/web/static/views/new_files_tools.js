// New files: a spreadsheet or a pattern that states their values.

import { post } from "../core/api.js";
import { h, render } from "../core/dom.js";
import { showError, toast } from "../core/messages.js";
import { button, chip, text } from "../parts/forms.js";
import { scrolled, tableOf } from "../parts/tables.js";
import { base, plural } from "./new_files_row.js";

/** What columns mean, where the page has other words than the library. */
const MEANINGS = { role: "type", wedge: "wedge angle" };
const SHOWN = [
  ["use", "type"],
  ["person", "person"],
  ["finger", "finger"],
  ["face", "face"],
  ["wedge_angle_deg", "wedge, °"],
  ["load_N", "load, N"],
  ["session", "session"],
];
const some = (names) =>
  names.slice(0, 8).join(", ") + (names.length > 8 ? ` and ${names.length - 8} more` : "");

export class NewFileTools {
  /**
   * @param {{ files: () => any[], take: (stated: Answers["StatedFile"][]) => void }} of the new files, and
   *   what takes values
   */
  constructor({ files, take }) {
    this.files = files;
    this.take = take;
    this.report = h("div", { "aria-live": "polite" });
    this.matches = /** @type {Answers["StatedFile"][]} */ ([]);
    this.preview = h("div", { "aria-live": "polite" });
    this.root = h("div.new-file-tools", [this.#sheet(), this.#pattern(), this.report]);
  }

  #sheet() {
    const area = h("textarea", {
      rows: 5,
      "aria-label": "Cells of a spreadsheet",
      placeholder: "file\tfinger\twedge\tload (N)\nIMG_0031\tindex\t30\t0.5",
      spellcheck: "false",
    });
    return h("details", [
      h("summary", "Fill in from a spreadsheet"),
      h(
        "p.soft",
        "Drop a CSV or XLSX file on the page, or paste its cells here. The first line names the columns: " +
          "file, and any of person, finger, face, type, wedge, load, scale, session.",
      ),
      area,
      h("div.actions", [button("Fill in", () => this.join({ text: area.value }))]),
    ]);
  }

  #pattern() {
    const field = text({
      label: "Pattern of the names",
      placeholder: "S{person}_{finger}_{wedge}deg_{load}N",
    });
    field.addEventListener("input", () => this.#match(field.value));
    const use = button("Fill in", () => {
      const fit = this.matches.filter(({ problem }) => !problem);
      this.take(fit);
      toast(`${plural(fit.length)} filled in by the pattern.`, { kind: "good" });
    });
    return h("details", [
      h("summary", "Fill in from the file names"),
      h(
        "p.soft",
        "Write the name of one file, with {person}, {finger}, {face}, {wedge}, {load} or {session} in " +
          "place of what changes, and * for anything else.",
      ),
      h("div.actions", [field, use]),
      this.preview,
    ]);
  }

  /** Join a spreadsheet that was dropped or pasted. */
  async join(source, files = this.files(), { quiet = false } = {}) {
    if (!files.length) return;
    if (source.text !== undefined && !source.text.trim()) return;
    try {
      const found = await post("/files/table", { ...source, files });
      if (quiet && !found.files.length) return;
      const problems = found.files
        .filter(({ problem }) => problem)
        .map(({ file, problem }) => `${base(file)}: ${problem}`);
      this.take(found.files);
      const unknown = found.columns.filter(({ header, meaning }) => header && meaning === null);
      render(this.report, [
        h("div.note", [
          h("strong", `${found.files.length} of ${files.length} files found in the spreadsheet. `),
          "Columns: ",
          found.columns
            .filter(({ meaning }) => meaning)
            .map(
              ({ header, meaning, unit }) =>
                `${header} → ${MEANINGS[meaning] ?? meaning}${unit ? `, ${unit}` : ""}`,
            )
            .join("; "),
          ".",
          unknown.length > 0 && h("p", `Not used: ${some(unknown.map(({ header }) => header))}.`),
          found.files_without_row.length > 0 &&
            h("p", `Files without a row: ${some(found.files_without_row.map(base))}.`),
          found.rows_without_file.length > 0 &&
            h("p", [
              "Rows without one file: ",
              some(found.rows_without_file.map(({ line, file }) => `${file || "no name"} (line ${line})`)),
              ".",
            ]),
          problems.length > 0 && h("p", `Not read: ${some(problems)}.`),
        ]),
      ]);
    } catch (error) {
      render(this.report, h("div.faults", { role: "alert" }, h("p", error.message)));
    }
  }

  /** Preview a pattern; an answer to an earlier pattern is dropped. */
  async #match(pattern) {
    const wanted = (this.wanted = pattern);
    this.matches = [];
    if (!pattern.includes("{")) return render(this.preview);
    try {
      const files = await post("/files/pattern", { pattern, files: this.files() });
      if (wanted !== this.wanted) return undefined;
      this.matches = files;
      const keys = SHOWN.filter(([key]) => files.some(({ values }) => values[key] !== null));
      const fit = files.filter(({ problem }) => !problem).length;
      return render(this.preview, [
        h("p.soft", `${fit} of ${files.length} names fit.`),
        scrolled(
          "What the pattern gives",
          tableOf(
            "table.tight",
            ["File", ...keys.map(([, words]) => words), ""],
            [...files]
              .sort((one, other) => Number(Boolean(other.problem)) - Number(Boolean(one.problem)))
              .slice(0, 40)
              .map(({ file, values, problem }) =>
                h("tr", [
                  h("td", base(file)),
                  keys.map(([key]) => h("td", values[key] ?? "")),
                  h("td", problem && chip(problem, "warn")),
                ]),
              ),
          ),
        ),
      ]);
    } catch (error) {
      if (wanted !== this.wanted) return undefined;
      return error.status === 422 ? render(this.preview, h("p.soft", error.message)) : showError(error);
    }
  }
}
