// Run the study, show its progress, and export the results.

import { download, get, post } from "../core/api.js";
import { button, h, render, update } from "../core/dom.js";
import { bindHere } from "../core/keys.js";
import { bytes } from "../core/quantity.js";
import { workspace } from "../core/workspace.js";
import { attempt, check, chip, choiceField, head, list, withoutOverlap } from "../parts/forms.js";
import { missingList } from "../parts/missing_fields.js";

const STATES = {
  idle: "Nothing is running",
  running: "Running",
  cancelling: "Stopping after the current images",
  done: "Finished",
  changed: "The last run has finished; the study has changed since",
  cancelled: "Stopped. Finished measurements are kept",
  failed: "The run failed",
};
const PHASES = { measuring: "measuring", tables: "writing tables", report: "writing the report" };

const FILES = [
  [
    "report.html",
    "Report",
    "A single HTML file with figures, overlays, tables and provenance. For studies of many fingers, the " +
      "ZIP of the study folder holds a page for each.",
  ],
  [
    "study.zip",
    "Study folder",
    "Images, manifest, corrections and results as a ZIP file, to import on another computer.",
  ],
  ["results.csv", "Results as CSV", "One row per contact and frame; units and _std in the headers."],
  ["results_columns.csv", "Column descriptions", "Data dictionary of the CSV."],
  ["by_load.csv", "Area and modulus by load", "Pooled over repeats, with what each uncertainty is made of."],
  ["repeatability.csv", "Repeatability", "Scatter of repeats, sessions, fingers and persons."],
  ["results.json", "Results as JSON", "The same rows as JSON."],
  ["summary.json", "Summary as JSON", "Pooled radii, versions, hashes of all inputs, formulas."],
];

const exportCard = (title, words, actions, more = null) =>
  h("section.card.export", { "aria-label": title }, [
    h("h3", title),
    h("p.soft", words),
    more,
    h("div.actions", actions || h("span.soft", "available after a run")),
  ]);

export class Run {
  constructor(root, rest) {
    this.workers = 1;
    this.fresh = false;
    this.problem = h("div");
    this.status = h("section.card.run-status", { "aria-label": "The run" });
    this.exports = h("div.exports");
    this.leftOut = h("div");
    render(root, [
      head("Run & export", "A run measures only what is new or has changed."),
      h("div.scroll.stack", [this.status, this.exports]),
    ]);
    this.removeListener = workspace.on("run", () => this.#draw());
    bindHere([
      ["Enter", "Run", () => this.#start()],
      ["c", "Stop the run", () => this.#cancel()],
    ]);
    this.#poll().catch(() => {});
    this.update();
    if (rest[0] === "start") {
      history.replaceState(null, "", "#/run");
      this.#start();
    }
  }

  get busy() {
    return ["running", "cancelling"].includes(workspace.run?.state);
  }

  get #hasComplete() {
    const { observations, sequences, curves } = workspace.study;
    return [...observations, ...sequences, ...curves].some(({ complete }) => complete);
  }

  #start = withoutOverlap(async () => {
    const { ready } = workspace.study;
    if (this.busy || !(ready || this.#hasComplete)) return;
    await attempt(this.problem, async () => {
      await post("/run", { workers: this.workers, force: this.fresh, incomplete: !ready });
      await this.#poll();
    });
  });

  async #cancel() {
    if (workspace.run?.state !== "running") return;
    await post("/run/cancel");
    await this.#poll();
  }

  /** Poll the status until the run has ended, as events may be lost. */
  async #poll() {
    clearTimeout(this.again);
    workspace.takeRun(await get("/run"));
    if (this.busy) this.again = setTimeout(() => this.#poll().catch(() => {}), 1000);
  }

  #draw() {
    const run = workspace.run ?? workspace.study.run;
    const { ready, counts, results, missing } = workspace.study;
    const finished = run.state === "done" && results?.fresh;
    const state = STATES[run.state === "done" && !finished ? "changed" : run.state];
    update(this.status, [
      h("header", [
        h("h2", state),
        h("span.sr", { role: "status" }, state),
        finished && chip("up to date", "good"),
        run.state === "failed" && chip("failed", "bad"),
      ]),
      this.busy
        ? [
            progressOf(run),
            h("div.actions", { key: "stop" }, [
              button("Stop", () => this.#cancel(), { kind: "bad", key: "c" }),
            ]),
          ]
        : [
            run.error && h("div.note.bad", { role: "alert" }, run.error),
            h("p", [
              [h("strong.number", counts.done), " measured, "],
              [h("strong.number", counts.left + counts.stale), " to do"],
              counts.failed > 0 && [", ", h("strong.number", counts.failed), " failed"],
              ".",
            ]),
            !ready &&
              h("div.note", [
                "The study is incomplete, and a run leaves out what lacks entries. ",
                h("a", { href: "#/study" }, "See the Study page."),
                missingList(missing.slice(0, 10), { named: true }),
              ]),
            h("div.run-options", [
              choiceField("Processes", {
                value: String(this.workers),
                options: ["1", "2", "4", "8"],
                onset: (value) => (this.workers = Number(value)),
              }),
              check("Re-measure all", { checked: this.fresh, onset: (on) => (this.fresh = on) }),
            ]),
            h("div.actions", { key: "actions" }, [
              button(ready ? "Run" : "Run what is complete", () => this.#start(), {
                kind: finished ? "" : "primary",
                key: "Enter",
                disabled: !ready && !this.#hasComplete,
              }),
              ["done", "cancelled"].includes(run.state) &&
                workspace.study.results?.there &&
                h(finished ? "a.button.primary" : "a.button", { href: "#/results" }, "See the results"),
            ]),
          ],
      run.failures?.length > 0 &&
        h("div.note.bad.failures", { tabindex: 0, role: "region", "aria-label": "Failures" }, [
          h("strong", `${run.failures.length} failed${finished ? "" : " in that run"}`),
          list(run.failures.slice(0, 50)),
        ]),
      this.problem,
    ]);
  }

  #drawExports() {
    const { results } = workspace.study;
    const { there } = results;
    render(this.exports, [
      h("div.headline", [
        h("h2", "Export"),
        there &&
          h("span.soft", results.fresh ? "up to date" : "from the last run; the study has changed since"),
      ]),
      h("div.export-grid", [
        FILES.map(([file, title, words]) => {
          const can = file === "study.zip" || (file === "report.html" ? results.report : there);
          const href = download(`${file}?attachment=1`);
          const link = { href, download: "", "aria-label": `Download ${title}` };
          const open = { href: download(file), target: "_blank", rel: "noopener" };
          return exportCard(
            title,
            words,
            can && [h("a.button", link, "Download"), file === "report.html" && h("a.button", open, "Open")],
            file === "study.zip" && this.leftOut,
          );
        }),
        exportCard(
          "Figures",
          "Each figure of the report as SVG, PDF, PNG and CSV.",
          there && h("a.button", { href: "#/results/figures" }, "Show figures"),
        ),
      ]),
    ]);
  }

  /** Show the contents of the ZIP and the files left out. */
  async #listBundle() {
    const { files, bytes: size, left_out: left } = await get("/bundle");
    render(this.leftOut, [
      h("p.soft.number", `${files} files, ${bytes(size)}`),
      left.length > 0 &&
        h("details", [
          h("summary", `${left.length} left out`),
          h("ul.rest.left-out", { tabindex: 0 }, [
            left.slice(0, 200).map(({ file, why }) => h("li", [h("code", file), `: ${why}`])),
            left.length > 200 && h("li.soft", `and ${left.length - 200} more, all listed in the ZIP`),
          ]),
        ]),
    ]);
  }

  update() {
    this.#listBundle().catch(() => {});
    this.#draw();
    this.#drawExports();
  }

  close() {
    clearTimeout(this.again);
    this.removeListener();
  }
}

/** @param {Answers["RunStatus"]} run */
function progressOf(run) {
  const measuring = phaseOf(run) === PHASES.measuring;
  const counted = run.total ? `${run.done} of ${run.total} measured · ` : "";
  const left = run.seconds_left ? `, about ${duration(run.seconds_left)} left` : "";
  const bar = h("progress", { "aria-label": "Progress of the run", max: Math.max(1, run.total) });
  if (measuring) bar.setAttribute("value", String(run.done));
  return [
    bar,
    h("p.run-line.number", [
      h("span", `${counted}${duration(run.seconds ?? 0)}${left}`),
      h("span", [`${phaseOf(run)} `, h("strong", { "data-live": "file" }, run.file || run.current)]),
    ]),
  ];
}

/**
 * What a run does now: how much there is to measure is not known at once, and often nothing is.
 * @param {Answers["RunStatus"]} run
 */
function phaseOf(run) {
  if (run.phase !== "measuring") return PHASES[run.phase] ?? "";
  if (!run.total) return "reading files and scales";
  return run.done < run.total ? PHASES.measuring : "evaluating";
}

function duration(seconds) {
  if (seconds < 60) return `${Math.round(seconds)} s`;
  if (seconds < 3600) return `${Math.floor(seconds / 60)} min ${Math.round(seconds % 60)} s`;
  return `${Math.floor(seconds / 3600)} h ${Math.round((seconds % 3600) / 60)} min`;
}
