// The start page: create, open or import a study.

import { post, send } from "../core/api.js";
import { button, h, render } from "../core/dom.js";
import { workspace } from "../core/workspace.js";
import { attempt, field, list, text, withoutOverlap } from "../parts/forms.js";

const mark = new URL("../mark.svg", import.meta.url).href;

/** Open a study, a new one, or a new copy of the example. @param {"open" | "new" | "example"} which */
async function enter(which, asked = {}) {
  workspace.take(await post(`/api/session/${which}`, /** @type {any} */ (asked)));
}

export class Welcome {
  constructor(root) {
    const { studies, workspace: folder } = workspace.session;
    this.problem = h("div");
    this.title = text({ placeholder: "Index fingers, spring 2026", required: true });
    this.chooser = h("input", {
      type: "file",
      accept: ".zip,application/zip",
      hidden: true,
      tabindex: -1,
      "aria-label": "ZIP file of a study",
      onchange: () => this.#import([...this.chooser.files]),
    });
    this.title.addEventListener("keydown", (event) => event.key === "Enter" && this.#create());
    render(root, [
      h("div.scroll.welcome", [
        h("header", [
          h("img", { src: mark, alt: "", width: 56, height: 56 }),
          h("div", [
            h("h1", "fingerpad"),
            h(
              "p.soft",
              "From photographs and fingerprints to corrected radii of curvature, each with its uncertainty.",
            ),
          ]),
        ]),
        h("div.welcome-grid", [
          h("section.card.stack", [
            h("h2", "New study"),
            field("Title", this.title, { hint: `A new folder is created in ${folder}.` }),
            h("div.actions", [
              button("Create study", () => this.#create(), { kind: "primary" }),
              button("Try the example", () => enter("example"), {
                title: "A small synthetic study: photographs, contacts and a loading curve of known truth",
              }),
            ]),
            this.problem,
          ]),
          h("section.card.stack", [
            h("h2", "Open study"),
            studies.length
              ? list(
                  studies.map(({ name, title }) =>
                    button([h("strong", title || name), title && h("code", name)], () =>
                      enter("open", { name }),
                    ),
                  ),
                  "ul.studies",
                )
              : h("p.soft", `There are no studies in ${folder} yet.`),
          ]),
          h("section.card.stack", [
            h("h2", "Import study"),
            h("p.soft", "A ZIP file exported by fingerpad: images, corrections and results."),
            h("div.actions", [button("Choose ZIP file", () => this.chooser.click()), this.chooser]),
          ]),
        ]),
        h("ol.how", [
          [
            "Drop photographs and contact images",
            "Set the scale",
            "Check outlines and contacts",
            "Run, and plot the corrected radius against load",
          ].map((words) => h("li", words)),
        ]),
      ]),
    ]);
    this.title.focus();
  }

  #create = withoutOverlap(async () => {
    const title = this.title.value.trim();
    if (!title) return this.title.focus();
    if (await attempt(this.problem, () => enter("new", { title }))) location.hash = "#/study";
    return undefined;
  });

  /** @param {File[]} files the one that was chosen */
  async #import([file]) {
    this.chooser.value = ""; // the same one may be chosen again
    if (!file) return;
    workspace.take(await send("/api/session/import", { file: file.name }, file));
  }
}
