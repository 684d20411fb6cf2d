// What a grid tells of a camera, and contact images written as if seen straight on.

import { post } from "../core/api.js";
import { h } from "../core/dom.js";
import { toast } from "../core/messages.js";
import { percent } from "../core/quantity.js";
import { workspace } from "../core/workspace.js";
import { button } from "../parts/forms.js";

const few = (share) => percent(share, share < 0.001 ? 2 : 1);

/** @param {NonNullable<ScaleMeasurement["grid"]>} grid */
export function gridWords(grid) {
  return h("dl.grid-words.number", [
    [
      ["Points off the plane", `${grid.residual_px.toFixed(2)} px`],
      ["Sides of a pixel differ by", few(grid.anisotropy)],
      ["Scale differs over the grid by", few(grid.variation)],
      ["Left once rectified", few(grid.unevenness)],
      ["Once rectified", grid.rectified_mm_per_px.words],
    ].map(([words, value]) => [h("dt", words), h("dd", value)]),
  ]);
}

/**
 * The button that rectifies contact images with a scale, once there are any.
 *
 * @param {string | undefined} scale its name, once it is saved
 * @param {() => Record<string, any>} definition of the grid
 * @param {(name: string) => void} done called with the name of the scale of the new pictures
 * @param {(error: any) => void} failed
 */
export function rectification(scale, definition, done, failed) {
  const images = workspace.study.observations.filter((each) => scale && each.file && each.scale === scale);
  if (!images.length) return h("p.soft", "Once contact images use this scale, they can be rectified here.");
  const rectify = async () => {
    const name = `${scale}_rectified`;
    try {
      const { files, mm_per_px, relative_std } = await post("/scale/rectify", {
        table: /** @type {any} */ (definition()),
        files: [...new Set(images.map(({ file }) => file))],
      });
      await workspace.edit(
        { kind: "scale", key: name, set: { mm_per_px, relative_std } },
        ...images.map(
          ({ item, file }) =>
            /** @type {Edit} */ ({ kind: "observation", key: item, set: { file: files[file], scale: name } }),
        ),
      );
    } catch (error) {
      failed(error);
      return;
    }
    toast(`${images.length} rectified, with the scale ${name}. The original images stay where they are.`, {
      kind: "good",
    });
    done(name);
  };
  return button(`Rectify ${images.length} contact image${images.length > 1 ? "s" : ""}`, rectify, {
    kind: "small",
    title: "Write them as if seen straight on, and measure these instead",
  });
}
