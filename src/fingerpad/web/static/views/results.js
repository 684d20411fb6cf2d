// Results: plots, table, figures, uncertainty budget and audit.

import { h, render } from "../core/dom.js";
import { bindHere } from "../core/keys.js";
import { workspace } from "../core/workspace.js";
import { empty, head, segments } from "../parts/forms.js";
import { doubtNotes } from "../parts/missing_fields.js";
import { showAudit, showBudget, showFigures, showSimulator } from "./results_parts.js";
import { Plots } from "./results_plots.js";
import { Table } from "./results_table.js";

/** @typedef {View & { load(): Promise<any>, search?(): void, theme?(): void }} Part */
/** @type {(show: (root: Element) => Promise<void>) => (root: Element) => Part} */
const stateless = (show) => (root) => ({ load: () => show(root) });

/** @type {[name: string, title: string, key: string, words: string, open: (root: Element) => Part][]} */
const PARTS = [
  ["plot", "Plots", "p", "Plots against load", (root) => new Plots(root)],
  ["table", "Table", "t", "Table", (root) => new Table(root)],
  ["figures", "Figures", "f", "All figures of the report", stateless(showFigures)],
  ["budget", "Uncertainty", "b", "Uncertainty budget", stateless(showBudget)],
  ["simulator", "Simulator", "s", "Numbers for robot simulators", stateless(showSimulator)],
  ["audit", "Audit", "a", "Audit of the published tables", stateless(showAudit)],
];

const RUN = ["#/run/start", "Run the study"];

export class Results {
  /** @type {Part | null} */
  part = null;

  constructor(root, rest) {
    this.body = h("div.scroll.results", { tabindex: 0, role: "region", "aria-label": "Results" });
    this.banner = h("div");
    this.tabs = segments(
      "Parts of the results",
      PARTS.map(([key, words]) => [key, words]),
      "plot",
      (key) => (location.hash = `#/results/${key}`),
    );
    render(root, [head("Results", "Values ± standard uncertainty.", this.tabs), this.banner, this.body]);
    bindHere([
      ...PARTS.map(([name, , key, words]) => [key, words, () => (location.hash = `#/results/${name}`)]),
      ["/", "Search the table", () => this.part?.search?.()],
    ]);
    this.removeListener = workspace.on("theme", () => this.part?.theme?.());
    this.navigate(rest);
  }

  navigate([part]) {
    this.#show(part);
    return true;
  }

  #show(part) {
    this.finished = workspace.study.results?.finished;
    const [key, , , , open] = PARTS.find(([name]) => name === part) ?? PARTS[0];
    this.key = key;
    this.tabs.show(key);
    this.part?.close?.();
    this.part = null;
    this.#sayFresh();
    const nothing = key !== "audit" && this.#nothing();
    if (nothing) {
      render(this.body, nothing);
      return;
    }
    // Each part has its own element, so that late answers of another part are not shown.
    const home = h("div", h("div.loading", { role: "status" }, "Reading the results …"));
    render(this.body, home);
    this.part = open(home);
    this.part
      .load()
      .catch((error) =>
        render(home, [
          h("div.empty", { role: "alert" }, [h("h2", "This cannot be shown"), h("p", error.message)]),
        ]),
      );
  }

  /** What stands in place of results that are not there, or damaged; nothing where they are good. */
  #nothing() {
    const { results, ready } = workspace.study;
    if (results.faults.length)
      return empty(
        "These results cannot be shown",
        `${results.faults.slice(0, 5).join("; ")}. Run the study again: finished measurements are reused.`,
        h("a.button.primary", { href: "#/run/start" }, "Run the study"),
      );
    if (results.there) return null;
    const [words, href, action] = ready
      ? ["The study is complete and can run. A later run measures only what has changed.", ...RUN]
      : ["The study is incomplete; see the Study page.", "#/study", "Go to study"];
    return empty(
      "No results yet",
      words,
      h("a.button.primary", { href }, action),
      h("a.button", { href: "#/results/audit" }, "See the audit of the published tables"),
    );
  }

  #sayFresh() {
    const { results, ready } = workspace.study;
    render(this.banner, [
      results.there && this.key !== "audit" && doubtNotes("div.banner.note"),
      results.there &&
        !results.fresh &&
        h("div.banner.note", [
          `The ${results.other_program ? "program" : "study"} has changed since the last run. `,
          h("a", { href: ready ? "#/run/start" : "#/study" }, "Run again"),
          " to update the results; only what has changed is measured.",
        ]),
    ]);
  }

  update() {
    this.#sayFresh();
    if (workspace.study.results?.finished !== this.finished) this.#show(this.key);
  }

  close() {
    this.removeListener();
    this.part?.close?.();
  }
}
