// The start page: create, open or import a study.

import { ApiError, addressOf } from "../core/api.js";
import { h, render } from "../core/dom.js";
import { showError } from "../core/messages.js";
import { workspace } from "../core/workspace.js";
import { attempt, button, field, list, text, withoutOverlap } from "../parts/forms.js";

const mark = new URL("../mark.svg", import.meta.url).href;

class Welcome {
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
      onchange: () => this.#import(this.chooser.files[0]),
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
              button("Try the example", () => this.#example(), {
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
                    h("button", { type: "button", onclick: () => workspace.open(name).catch(showError) }, [
                      h("strong", title || name),
                      title && h("code", name),
                    ]),
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
    if (await attempt(this.problem, () => workspace.create(title))) location.hash = "#/study";
    return undefined;
  });

  #example = withoutOverlap(() => workspace.createExample().catch(showError));

  async #import(file) {
    if (!file) return;
    const response = await fetch(addressOf("/api/session/import", { file: file.name }), {
      method: "POST",
      headers: { "content-type": "application/zip" },
      body: file,
    });
    const answer = await response.json().catch(() => null);
    if (!response.ok) return showError(new ApiError(response.status, answer));
    workspace.update(answer);
  }
}

/** @returns {View} */
export const open = (root) => /** @type {any} */ (new Welcome(root));
