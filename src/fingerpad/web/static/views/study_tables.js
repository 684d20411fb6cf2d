// Tables of fingers, contacts, sequences and loading data, edited in place.

import { picture } from "../core/api.js";
import { h, redraw, render } from "../core/dom.js";
import { symbol } from "../core/glossary.js";
import { ask } from "../core/messages.js";
import { plain, withStd } from "../core/quantity.js";
import { describeCode, workspace } from "../core/workspace.js";
import { button, chip, choose, faultList, field, NAME, number, synthetic, text } from "../parts/forms.js";
import { missingList, missingOf } from "../parts/missing_fields.js";
import { scaleChoice } from "../parts/scale_choice.js";

const PAGE = 50;
const AXES = [
  ["palmar", "Palmar"],
  ["distal", "Distal"],
  ["radial_ulnar", "Radial–ulnar"],
];
const STATUS = {
  done: ["measured", "good"],
  left: ["not measured", ""],
  stale: ["changed", "warn"],
  failed: ["failed", "bad"],
  given: ["given", ""],
  rejected: ["rejected", "bad"],
};

/** @param {{ status: string, reason?: string | null }} entry */
const statusChip = ({ status, reason }) =>
  chip(...(STATUS[status] ?? [status ?? "", ""]), reason ?? undefined);
const incomplete = ({ complete }) => complete === false && chip("incomplete", "warn");

/**
 * Name the column of each cell, for small screens, on which a row becomes a card.
 *
 * @param {HTMLTableElement} table
 */
function labelCells(table) {
  const labels = [...table.tHead.rows[0].cells].map((cell) => cell.textContent);
  for (const row of table.tBodies[0].rows) {
    for (const [k, cell] of [...row.cells].entries()) {
      if (k < labels.length - 1) cell.dataset.label = labels[k];
    }
  }
}

export class StudyTables {
  constructor() {
    this.page = 0;
    this.problem = h("div");
    this.root = h("div.stack");
  }

  draw() {
    const { fingers, observations, sequences, curves } = workspace.study;
    render(
      this.root,
      this.problem,
      this.#fingers(fingers),
      this.#observations(observations),
      (sequences.length > 0 || null) && this.#sequences(sequences),
      this.#curves(curves),
    );
    for (const table of this.root.querySelectorAll("table")) labelCells(table);
  }

  async change(kind, key, set) {
    render(this.problem);
    try {
      await workspace.edit({ kind, key, set });
    } catch (error) {
      redraw(() => this.draw()); // fields show the stored values again
      render(this.problem, faultList(error));
      this.problem.scrollIntoView({ block: "nearest" });
    }
  }

  async #remove(kind, key, words) {
    const answer = await ask(
      `Remove ${words} from the study?`,
      h("p", null, "Its file stays in the study folder."),
      [
        ["", "Cancel"],
        ["yes", "Remove", "bad"],
      ],
    );
    if (answer === "yes") this.change(kind, key, null);
  }

  /** @param {Finger[]} fingers */
  #fingers(fingers) {
    return h(
      "section.card",
      { "aria-label": "Fingers" },
      h(
        "header",
        null,
        h("h2", null, "Fingers"),
        h("span.soft", null, "semi-axes from photographs or entered"),
        h(
          "div.actions",
          null,
          button("Add a finger", () => this.#addFinger(), { kind: "small" }),
        ),
      ),
      fingers.length
        ? h(
            "div.table-wrap",
            { tabindex: 0, role: "group", "aria-label": "Fingers" },
            h(
              "table.tight",
              null,
              h(
                "thead",
                null,
                h(
                  "tr",
                  null,
                  h("th", { scope: "col" }, "Finger"),
                  AXES.map(([, words]) => h("th.number", { scope: "col" }, `${words}, mm`)),
                  h(
                    "th.number",
                    { scope: "col", title: "effective thickness of the tissue over bone" },
                    "Thickness, mm",
                  ),
                  h("th", { scope: "col" }, "Photographs"),
                  h("th", { scope: "col" }, h("span.sr", null, "Actions")),
                ),
              ),
              h(
                "tbody",
                null,
                fingers.map((finger) => this.#finger(finger)),
              ),
            ),
          )
        : h("p.soft", null, "No fingers yet. Add a photograph, or enter the semi-axes."),
    );
  }

  /** @param {Finger} finger */
  #finger(finger) {
    const typed = finger.table.semi_axes_mm;
    return h(
      "tr",
      null,
      h(
        "td",
        null,
        h("strong", null, finger.name),
        " ",
        synthetic(finger.synthetic),
        " ",
        incomplete(finger),
      ),
      AXES.map(([axis]) =>
        h("td.number", null, withStd(finger.semi_axes_mm?.[axis], finger.semi_axes_mm_std?.[axis])),
      ),
      h(
        "td.number",
        null,
        button(
          finger.table.effective_thickness_mm === undefined
            ? "Enter"
            : withStd(finger.table.effective_thickness_mm, finger.table.effective_thickness_mm_std),
          () => this.#thickness(finger),
          { kind: "small", label: `Thickness of ${finger.name}`, title: "Effective thickness over bone" },
        ),
      ),
      h(
        "td",
        null,
        finger.photographs?.length
          ? h(
              "div.faces",
              null,
              finger.photographs.map((photograph) => this.#face(photograph)),
            )
          : typed
            ? h("span.soft", null, "entered")
            : h("span.soft", null, "none"),
      ),
      h(
        "td",
        null,
        h(
          "div.actions",
          null,
          !finger.photographs?.length &&
            button("Semi-axes", () => this.#semiAxes(finger), {
              kind: "small",
              label: `Semi-axes of ${finger.name}`,
            }),
          button("✎", () => this.#rename(finger), {
            kind: "icon",
            label: `Rename ${finger.name}`,
            title: "Rename",
          }),
          button("×", () => this.#remove("finger", finger.name, finger.name), {
            kind: "icon",
            label: `Remove ${finger.name}`,
          }),
        ),
      ),
    );
  }

  /** @param {Finger["photographs"][number]} photograph */
  #face(photograph) {
    const words = [photograph.face, photograph.outline && "outline"].filter(Boolean).join(", ");
    const kind = photograph.rejected ? "warn" : photograph.accepted ? "good" : "";
    const name = photograph.file?.split("/").at(-1);
    return h(
      "div.face",
      null,
      photograph.outline
        ? words && chip(words, kind)
        : h(
            "a.face-link",
            {
              href: `#/photographs/${encodeURIComponent(photograph.item)}`,
              title: photograph.file,
              "aria-label": `Photograph ${name}`,
            },
            h("img.small-thumb", { src: picture("thumbnail", photograph.item), alt: "", loading: "lazy" }),
            words && chip(words, kind),
          ),
      missingList(missingOf("photograph", photograph.item)),
      button("×", () => this.#remove("photograph", photograph.item, `the photograph ${name}`), {
        kind: "icon",
        label: `Remove the photograph ${name}`,
        title: "Remove this photograph",
      }),
    );
  }

  /** Ask for the name of a finger; empty if cancelled. */
  async #askName(words, doing, value = "") {
    const name = text({ placeholder: "left_index", value, pattern: NAME });
    const body = h("div", null, field("Name of the finger", name, { hint: "Letters, digits, - and _." }));
    const answer = await ask(words, body, [
      ["", "Cancel"],
      ["yes", doing, "primary"],
    ]);
    return answer === "yes" ? name.value.trim() : "";
  }

  async #addFinger() {
    const name = await this.#askName("Add a finger", "Add");
    if (!name) return;
    await this.change("finger", name, {});
    const made = workspace.study.fingers.find((finger) => finger.name === name);
    if (made && !made.photographs?.length) this.#semiAxes(made);
  }

  /** @param {Finger} finger */
  async #rename(finger) {
    const name = await this.#askName(`Rename ${finger.name}`, "Rename", finger.name);
    if (name && name !== finger.name) this.change("finger", finger.name, { name });
  }

  /** Ask for the semi-axes of a finger by its name. */
  askSemiAxes(name) {
    const finger = workspace.study.fingers.find((each) => each.name === name);
    if (finger) this.#semiAxes(finger);
  }

  /** @param {Finger} finger */
  async #semiAxes(finger) {
    const { semi_axes_mm: now = {}, semi_axes_mm_std: std = {} } = finger.table ?? {};
    const inputs = AXES.map(([axis, words]) => [
      axis,
      words,
      number({ value: now[axis], min: 0 }),
      number({ value: std[axis], min: 0 }),
    ]);
    const body = h(
      "div.stack",
      null,
      h(
        "p",
        null,
        "Semi-axes of the pad with standard uncertainties. Leave them empty if photographs follow.",
      ),
      h(
        "div.fields.two",
        null,
        inputs.map(([, words, value, its]) => [
          field(words, value, { unit: "mm" }),
          field("± (standard uncertainty)", its, { unit: "mm" }),
        ]),
      ),
    );
    const answer = await ask(`Semi-axes of ${finger.name}`, body, [
      ["", "Cancel"],
      ["yes", "Save", "primary"],
    ]);
    const value = (input) => (input.value === "" ? undefined : Number(input.value));
    if (answer !== "yes" || inputs.every(([, , input]) => input.value === "")) return;
    this.change("finger", finger.name, {
      semi_axes_mm: Object.fromEntries(inputs.map(([axis, , input]) => [axis, value(input)])),
      semi_axes_mm_std: Object.fromEntries(inputs.map(([axis, , , input]) => [axis, value(input) ?? 0])),
    });
  }

  /** @param {Finger} finger */
  async #thickness(finger) {
    /** @type {Record<string, any>} */
    const { effective_thickness_mm: now, effective_thickness_mm_std: std } = finger.table;
    const [value, its] = [now, std].map((each) => number({ value: each, min: 0 }));
    const body = h(
      "div.stack",
      null,
      h(
        "p",
        null,
        "Effective thickness of the tissue over bone: that of a flat layer which acts like this finger's narrow and " +
          "curved bone. Results then show the whole pad on that layer beside Hertz theory. Without an uncertainty it " +
          "is taken as exact; empty fields remove it.",
      ),
      h(
        "div.fields.two",
        null,
        field("Effective thickness", value, { unit: "mm" }),
        field("± (standard uncertainty)", its, { unit: "mm" }),
      ),
    );
    const answer = await ask(`Thickness of ${finger.name}`, body, [
      ["", "Cancel"],
      ["yes", "Save", "primary"],
    ]);
    if (answer !== "yes") return;
    const typed = (input) => (input.value === "" ? null : Number(input.value));
    this.change("finger", finger.name, {
      effective_thickness_mm: typed(value),
      effective_thickness_mm_std: typed(its),
    });
  }

  /** @param {Observation[]} observations */
  #observations(observations) {
    const rolled =
      observations.some(({ roll_angle_deg: roll }) => roll) ||
      workspace.study.uncertainty.roll_angle_deg_std > 0;
    const pages = Math.max(1, Math.ceil(observations.length / PAGE));
    this.page = Math.min(this.page, pages - 1);
    const shown = observations.slice(this.page * PAGE, (this.page + 1) * PAGE);
    return h(
      "section.card",
      { "aria-label": "Contacts" },
      h(
        "header",
        null,
        h("h2", null, "Contacts"),
        h("span.soft", null, `${observations.length} in all`),
        pages > 1 && this.#pager(pages),
      ),
      observations.length
        ? h(
            "div.table-wrap",
            { tabindex: 0, role: "group", "aria-label": "Contacts" },
            h(
              "table.tight",
              null,
              h(
                "thead",
                null,
                h(
                  "tr",
                  null,
                  [
                    "Contact",
                    "Finger",
                    "Wedge, °",
                    ...(rolled ? ["Roll, °"] : []),
                    "Load, N",
                    "Scale",
                    "Status",
                    "",
                  ].map((words) => h("th", { scope: "col" }, words || h("span.sr", null, "Actions"))),
                ),
              ),
              h(
                "tbody",
                null,
                shown.map((observation) => this.#observation(observation, rolled)),
              ),
            ),
          )
        : h("p.soft", null, "No contacts yet. Drop contact images above; each is one contact at one load."),
    );
  }

  #pager(pages) {
    const go = (by) => () => {
      this.page += by;
      this.draw();
    };
    return h(
      "div.actions",
      null,
      button("‹", go(-1), { kind: "small", disabled: this.page === 0, label: "Previous page" }),
      h("span.number", null, `${this.page + 1} of ${pages}`),
      button("›", go(1), { kind: "small", disabled: this.page === pages - 1, label: "Next page" }),
    );
  }

  /**
   * @param {Observation} one
   * @param {boolean} rolled
   */
  #observation(one, rolled) {
    const set = (key) => (value) => this.change("observation", one.item, { [key]: value });
    const num = (key, words, more) =>
      h(
        "td",
        { "data-empty": (one[key] === null || one[key] === undefined) && key !== "roll_angle_deg" },
        number({
          value: one[key],
          min: 0,
          label: `${words} of ${one.item}`,
          onset: set(key),
          ...more,
        }),
      );
    return h(
      "tr",
      null,
      h(
        "td",
        null,
        one.file ? h("a", { href: `#/contacts/images/${encodeURIComponent(one.item)}` }, one.item) : one.item,
        " ",
        synthetic(one.synthetic),
        one.flags.length > 0 && [" ", chip("flagged", "warn", one.flags.map(describeCode).join("; "))],
      ),
      h(
        "td",
        null,
        choose({
          value: one.finger ?? "",
          options: [
            ...(one.finger ? [] : [["", "– select –"]]),
            ...workspace.study.fingers.map(({ name }) => name),
          ],
          label: `Finger of ${one.item}`,
          onset: set("finger"),
        }),
      ),
      num("wedge_angle_deg", "Wedge angle", { max: 90 }),
      rolled && num("roll_angle_deg", "Roll angle", { min: undefined }),
      num("load_N", "Load"),
      one.file
        ? h(
            "td",
            { "data-empty": !one.scale },
            scaleChoice({ value: one.scale, label: `Scale of ${one.item}`, onset: set("scale") }),
          )
        : h("td.soft", null, "ellipse given"),
      h("td", null, incomplete(one) || statusChip(one)),
      h(
        "td",
        null,
        button("×", () => this.#remove("observation", one.item, one.item), {
          kind: "icon",
          label: `Remove ${one.item}`,
        }),
      ),
    );
  }

  /** @param {Sequence[]} sequences */
  #sequences(sequences) {
    const tables = workspace.study.files.filter(({ kind }) => kind === "table").map(({ file }) => file);
    return h(
      "section.card",
      { "aria-label": "Sequences" },
      h("header", null, h("h2", null, "Sequences"), h("span.soft", null, "contact images with force")),
      h(
        "div.table-wrap",
        { tabindex: 0, role: "group", "aria-label": "Sequences" },
        h(
          "table.tight",
          null,
          h(
            "thead",
            null,
            h(
              "tr",
              null,
              ["Sequence", "Finger", "Wedge, °", "Force, frame rate", "Scale", "Status", ""].map((words) =>
                h("th", { scope: "col" }, words || h("span.sr", null, "Actions")),
              ),
            ),
          ),
          h(
            "tbody",
            null,
            sequences.map((one) => {
              const set = (key) => (value) => this.change("sequence", one.name, { [key]: value });
              const force = [...new Set([one.force, ...tables].filter(Boolean))];
              return h(
                "tr",
                null,
                h(
                  "td",
                  null,
                  h("a", { href: `#/contacts/${encodeURIComponent(`film:${one.name}`)}` }, one.name),
                  " ",
                  synthetic(one.synthetic),
                  one.frames && h("div.soft.number", null, `${one.frames} frames`),
                ),
                h(
                  "td",
                  null,
                  choose({
                    value: one.finger ?? "",
                    options: workspace.study.fingers.map(({ name }) => name),
                    label: `Finger of ${one.name}`,
                    onset: set("finger"),
                  }),
                ),
                h(
                  "td",
                  null,
                  number({
                    value: one.wedge_angle_deg,
                    min: 0,
                    max: 90,
                    label: `Wedge angle of ${one.name}`,
                    onset: set("wedge_angle_deg"),
                  }),
                ),
                h(
                  "td",
                  null,
                  choose({
                    value: one.force ?? "",
                    options: [["", "– select CSV –"], ...force.map((file) => [file, file.split("/").at(-1)])],
                    label: `Force of ${one.name}`,
                    onset: set("force"),
                  }),
                  h(
                    "div.control.below",
                    null,
                    number({
                      value: one.frames_per_second,
                      min: 0,
                      label: `Frames per second of ${one.name}`,
                      onset: set("frames_per_second"),
                    }),
                    h("span.unit", null, "frames/s"),
                  ),
                ),
                h(
                  "td",
                  null,
                  scaleChoice({ value: one.scale, label: `Scale of ${one.name}`, onset: set("scale") }),
                ),
                h("td", null, incomplete(one) || statusChip(one)),
                h(
                  "td",
                  null,
                  button("×", () => this.#remove("sequence", one.name, one.name), {
                    kind: "icon",
                    label: `Remove ${one.name}`,
                  }),
                ),
              );
            }),
          ),
        ),
      ),
    );
  }

  /** @param {State["curves"]} curves */
  #curves(curves) {
    return h(
      "section.card",
      { "aria-label": "Loading data" },
      h(
        "header",
        null,
        h("h2", null, "Loading data"),
        h("span.soft", null, "force–displacement curves, or ", symbol("R_g"), " from elsewhere"),
        h(
          "div.actions",
          null,
          button(
            h("span", null, "Add ", symbol("R_g", { inControl: true }), " from elsewhere"),
            () => this.#addRadius(),
            {
              kind: "small",
              disabled: !workspace.study.fingers.length,
            },
          ),
        ),
      ),
      curves.length
        ? h(
            "div.table-wrap",
            { tabindex: 0, role: "group", "aria-label": "Loading data" },
            h(
              "table.tight",
              null,
              h(
                "thead",
                null,
                h(
                  "tr",
                  null,
                  ["Source", "Finger", "Wedge, °", "R_g, mm", "Status", ""].map((words) =>
                    h(
                      "th",
                      { scope: "col", class: words.startsWith("R") ? "number" : undefined },
                      words.startsWith("R_g")
                        ? [symbol("R_g"), ", mm"]
                        : words || h("span.sr", null, "Actions"),
                    ),
                  ),
                ),
              ),
              h(
                "tbody",
                null,
                curves.map((one) =>
                  h(
                    "tr",
                    null,
                    h("td", null, one.file ?? "from elsewhere", " ", synthetic(one.synthetic)),
                    h("td", null, one.finger ?? "–"),
                    h(
                      "td",
                      null,
                      number({
                        value: one.wedge_angle_deg,
                        min: 0,
                        max: 90,
                        label: `Wedge angle of curve ${one.key}`,
                        onset: (value) => this.change("curve", one.key, { wedge_angle_deg: value }),
                      }),
                    ),
                    h(
                      "td.number",
                      null,
                      one.loading_radius_mm
                        ? withStd(one.loading_radius_mm, one.loading_radius_mm_std)
                        : one.file
                          ? "from the curve"
                          : plain(null),
                    ),
                    h("td", null, incomplete(one) || statusChip(one)),
                    h(
                      "td",
                      null,
                      button("×", () => this.#remove("curve", one.key, one.file ?? "this radius"), {
                        kind: "icon",
                        label: `Remove curve ${one.key}`,
                      }),
                    ),
                  ),
                ),
              ),
            ),
          )
        : h(
            "p.soft",
            null,
            "None. The study runs without them; ",
            symbol("R_g"),
            " is then not compared with the corrected radius.",
          ),
    );
  }

  async #addRadius() {
    const finger = choose({
      value: workspace.study.fingers[0].name,
      options: workspace.study.fingers.map(({ name }) => name),
    });
    const wedge = number({ min: 0, max: 90 });
    const radius = number({ min: 0 });
    const std = number({ min: 0 });
    const answer = await ask(
      "R_g from loading data",
      h(
        "div.fields",
        null,
        field("Finger", finger),
        field("Wedge angle", wedge, { unit: "°" }),
        field("R_g", radius, { unit: "mm" }),
        field("± (standard uncertainty)", std, { unit: "mm" }),
      ),
      [
        ["", "Cancel"],
        ["yes", "Add", "primary"],
      ],
    );
    if (answer !== "yes" || radius.value === "") return;
    const set = { finger: finger.value, loading_radius_mm: Number(radius.value) };
    if (wedge.value !== "") set.wedge_angle_deg = Number(wedge.value);
    if (std.value !== "") set.loading_radius_mm_std = Number(std.value);
    this.change("curve", String(workspace.study.curves.length), set);
  }
}
