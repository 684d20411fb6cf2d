// Before a study is open: begin one, open one, or bring one from another machine.

import { ApiError } from "../core/api.js";
import { h, place } from "../core/dom.js";
import { complain } from "../core/messages.js";
import { bench } from "../core/workspace.js";
import { alone, button, faultList, field, text } from "../parts/forms.js";

class Welcome {
  constructor(root) {
    const { studies, workspace } = bench.session;
    this.problem = h("div");
    this.title = text({ placeholder: "Index fingers, spring 2026", required: true });
    this.chooser = h("input", {
      type: "file",
      accept: ".zip,application/zip",
      hidden: true,
      tabindex: -1,
      "aria-label": "ZIP of a study",
      onchange: () => this.#import(this.chooser.files[0]),
    });
    this.title.addEventListener("keydown", (event) => event.key === "Enter" && this.#create());
    place(
      root,
      h(
        "div.scroll.welcome",
        null,
        h(
          "header",
          null,
          h("img", { src: "/static/mark.svg", alt: "", width: 56, height: 56 }),
          h(
            "div",
            null,
            h("h1", null, "The bench"),
            h(
              "p.soft",
              null,
              "From photographs and fingerprints to corrected radii of curvature, each with its uncertainty.",
            ),
          ),
        ),
        h(
          "div.welcome-grid",
          null,
          h(
            "section.card.stack",
            null,
            h("h2", null, "Begin a study"),
            field("What it is about", this.title, { hint: `A folder of its own is made in ${workspace}.` }),
            h(
              "div.actions",
              null,
              button("Begin", () => this.#create(), { kind: "primary" }),
            ),
            this.problem,
          ),
          h(
            "section.card.stack",
            null,
            h("h2", null, "Open a study"),
            studies.length
              ? h(
                  "ul.studies",
                  null,
                  studies.map(({ name, title }) =>
                    h(
                      "li",
                      null,
                      h(
                        "button",
                        { type: "button", onclick: () => bench.open(name).catch(complain) },
                        h("strong", null, title || name),
                        title && h("code", null, name),
                      ),
                    ),
                  ),
                )
              : h("p.soft", null, `There is none in ${workspace} yet.`),
          ),
          h(
            "section.card.stack",
            null,
            h("h2", null, "Bring a study"),
            h("p.soft", null, "The ZIP that another bench exported: pictures, corrections and results."),
            h(
              "div.actions",
              null,
              button("Choose a ZIP", () => this.chooser.click()),
              this.chooser,
            ),
          ),
        ),
        h(
          "ol.how",
          null,
          [
            "Drop photographs and contact images",
            "Set the scale",
            "Check outlines and contacts",
            "Run, and read the corrected radius against load",
          ].map((words) => h("li", null, words)),
        ),
      ),
    );
    this.title.focus();
  }

  #create = alone(async () => {
    const title = this.title.value.trim();
    if (!title) return this.title.focus();
    const name =
      title
        .normalize("NFKD")
        .replace(/\p{M}/gu, "")
        .toLowerCase()
        .replace(/[^a-z0-9]+/g, "-")
        .replace(/^-+|-+$/g, "")
        .slice(0, 60) || "study";
    place(this.problem);
    try {
      await bench.create(name, title);
      location.hash = "#/study";
    } catch (error) {
      place(this.problem, faultList(error));
    }
    return undefined;
  });

  async #import(file) {
    if (!file) return;
    const stem =
      file.name
        .replace(/\.zip$/i, "")
        .replace(/[^A-Za-z0-9._-]+/g, "-")
        .replace(/^[.-]+/, "")
        .slice(0, 56) || "study";
    const taken = new Set(bench.session.studies.map((study) => study.name));
    let name = stem;
    for (let number = 2; taken.has(name); number += 1) name = `${stem}-${number}`;
    const response = await fetch(`/api/session/import?${new URLSearchParams({ name })}`, {
      method: "POST",
      headers: { "content-type": "application/zip" },
      body: file,
    });
    const answer = await response.json().catch(() => null);
    if (!response.ok) return complain(new ApiError(response.status, answer));
    bench.take(answer);
  }
}

export const open = (root) => new Welcome(root);
