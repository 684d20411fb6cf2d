// The images that have a scale, chosen from all of a study.

import { h } from "../core/dom.js";
import { workspace } from "../core/workspace.js";
import { button } from "../parts/forms.js";

export class ScaleImages {
  /** @param {string | undefined} scale its name, once it is saved */
  constructor(scale) {
    this.scale = scale;
    /** @type {Map<HTMLInputElement, any>} */
    this.takers = new Map();
    this.parts = this.#draw();
  }

  /** Edits that give a scale to all that are chosen. @param {string} name @returns {Edit[]} */
  edits(name) {
    return [...this.takers]
      .filter(([box, { scale }]) => box.checked && scale !== name)
      .map(([, { kind, key }]) => ({ kind, key, set: { scale: name } }));
  }

  #draw() {
    const study = workspace.study;
    const rows = [
      ...study.fingers.flatMap((finger) =>
        (finger.photographs ?? [])
          .filter(({ outline }) => !outline)
          .map((each) => ["photograph", each.item, `${finger.name}, ${each.face ?? "?"} face`, each.scale]),
      ),
      ...study.observations
        .filter(({ file }) => file)
        .map((each) => ["observation", each.item, each.item, each.scale]),
      ...study.sequences.map((each) => ["sequence", each.name, `sequence ${each.name}`, each.scale]),
    ];
    // Photographs and contact images rarely share a camera: select the first kind that lacks a scale.
    const lacking = rows.find((row) => !row[3])?.[0];
    const boxes = rows.map(([kind, key, label, scale]) => {
      const mine = this.scale && scale === this.scale;
      const box = h("input", {
        type: "checkbox",
        checked: mine || (!this.scale && !scale && kind === lacking),
      });
      this.takers.set(box, { kind, key, scale });
      return h("label.check", { "data-kind": kind }, [
        box,
        h("span", label),
        h("span.soft", scale ? (mine ? "" : typeof scale === "string" ? scale : "own scale") : "none yet"),
      ]);
    });
    const only = (kind) => {
      for (const [box, taker] of this.takers) box.checked = taker.kind === kind;
    };
    const has = (kind) => rows.some(([other]) => other === kind);
    return [
      h("h3", "Images with this scale"),
      rows.length
        ? h("div.takers", { tabindex: 0, role: "group", "aria-label": "Images with this scale" }, boxes)
        : h("p.soft", "No images yet; choose this scale when you add them."),
      h("div.actions", [
        has("photograph") && button("Only photographs", () => only("photograph"), { kind: "small" }),
        has("observation") && button("Only contact images", () => only("observation"), { kind: "small" }),
      ]),
    ];
  }
}
