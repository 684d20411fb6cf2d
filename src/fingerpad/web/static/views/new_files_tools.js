// New files: a spreadsheet or a pattern that states their values.

import { LatestRequest, post } from "../core/api.js";
import { button, h, render } from "../core/dom.js";
import { showError, toast } from "../core/messages.js";
import { counted } from "../core/quantity.js";
import { chip, faultList, text } from "../parts/forms.js";
import { scrolled, tableOf } from "../parts/tables.js";
import { base } from "./new_files_row.js";

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
    const names = new LatestRequest(
      (pattern) => post("/files/pattern", { pattern, files: this.files() }),
      (files) => this.#show(files),
      (error) => (error.status === 422 ? render(this.preview, h("p.soft", error.message)) : showError(error)),
    );
    field.addEventListener("input", () => {
      this.matches = [];
      names.cancel();
      if (field.value.includes("{")) names.request(field.value);
      else render(this.preview);
    });
    const use = button("Fill in", () => {
      const fit = this.matches.filter(({ problem }) => !problem);
      this.take(fit);
      toast(`${counted(fit.length, "file")} filled in by the pattern.`, { kind: "good" });
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
      const unfound = found.rows_without_file.map(({ line, file }) => `${file || "no name"} (line ${line})`);
      /** @type {[words: string, names: string[]][]} */
      const notes = [
        ["Not used", unknown.map(({ header }) => header)],
        ["Files without a row", found.files_without_row.map(base)],
        ["Rows without one file", unfound],
        ["Not read", problems],
      ];
      render(this.report, [
        h("div.note", [
          h("strong", `${found.files.length} of ${files.length} files found in the spreadsheet. `),
          "Columns: ",
          found.columns
            .filter(({ meaning }) => meaning)
            .map(({ header, meaning }) => `${header} → ${MEANINGS[meaning] ?? meaning}`)
            .join("; "),
          ".",
          notes.map(([words, names]) => names.length > 0 && h("p", `${words}: ${some(names)}.`)),
        ]),
      ]);
    } catch (error) {
      render(this.report, faultList(error));
    }
  }

  /** Show what the pattern gives. @param {Answers["StatedFile"][]} files */
  #show(files) {
    this.matches = files;
    const keys = SHOWN.filter(([key]) => files.some(({ values }) => key in values));
    const fit = files.filter(({ problem }) => !problem).length;
    const byProblem = (one, other) => Number(Boolean(other.problem)) - Number(Boolean(one.problem));
    render(this.preview, [
      h("p.soft", `${fit} of ${files.length} names fit.`),
      scrolled(
        "What the pattern gives",
        tableOf(
          "table.tight",
          ["File", ...keys.map(([, words]) => words), ""],
          [...files]
            .sort(byProblem)
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
  }
}
