// Figures of the report.

import { get } from "../core/api.js";
import { h, render } from "../core/dom.js";
import { figureButton } from "../parts/figure_settings.js";
import { choiceField } from "../parts/forms.js";

export class Figures {
  constructor(root) {
    this.root = root;
  }

  async load() {
    const { figures } = await get("/results/figures");
    const kinds = [
      ["", "all figures"],
      ["corrected_radius", "corrected radius"],
      ["pad", "pad and contact"],
      ["area", "area against load"],
      ["aspect_ratio", "aspect ratio"],
      ["on_layer", "effect of a thickness"],
      ["section", "section to the bone"],
      ["budget", "uncertainty budget"],
      ["curve", "loading curves"],
      ["sequence", "sequences"],
    ];
    this.grid = h("div.figure-grid");
    const draw = (kind) => {
      const shown = figures.filter(
        ({ name }) =>
          !kind || (["curve", "sequence"].includes(kind) ? name.startsWith(kind) : name.endsWith(kind)),
      );
      render(this.grid, [
        shown.map((figure) => this.#card(figure)),
        !shown.length && h("p.soft", "There are no such figures in this study."),
      ]);
    };
    render(this.root, [h("div.plot-bar", choiceField("Show", { options: kinds, onset: draw })), this.grid]);
    draw("");
  }

  /** @param {Answers["Figures"]["figures"][number]} figure */
  #card(figure) {
    const { name, caption, svg, png } = figure;
    const words = caption || name.replaceAll("_", " ");
    const save = (address, kind) =>
      h("a.button", { href: `${address}?attachment=1`, "aria-label": `${kind} of ${name}` }, kind);
    return h("figure.card", [
      h("img", { src: svg, alt: words, loading: "lazy" }),
      h("figcaption", [
        h("p", words),
        h("div.actions", [save(svg, "SVG"), png && save(png, "PNG"), figureButton(figure, "")]),
      ]),
    ]);
  }
}
