// New files: what each of them is, entered one by one or for all.

import { get, picture, post, remove } from "../core/api.js";
import { h, redraw, render } from "../core/dom.js";
import { showError, toast } from "../core/messages.js";
import { bytes } from "../core/quantity.js";
import { workspace } from "../core/workspace.js";
import { button, check, choose, faultList, NAME, number, text } from "../parts/forms.js";
import { FACES } from "../parts/missing_fields.js";
import { scaleNames } from "../parts/scale_choice.js";

const KINDS = {
  picture: [
    ["observation", "contact image"],
    ["photograph", "photograph"],
    ["", "ruler or coin, later"],
  ],
  film: [["sequence", "sequence"]],
  table: [
    ["curve", "loading curve"],
    ["outline", "outline of a face"],
    ["", "force of a sequence, later"],
  ],
  other: [["", "unknown"]],
};

/** Name and values of a new file, as a proposal; empty where its name leaves them open. */
function draftOf({ file, reading }) {
  const { fingers } = workspace.study;
  return {
    name: file
      .split("/")
      .at(-1)
      .replace(/\.[^.]+$/, ""),
    as: reading.role ?? "",
    finger: reading.finger ?? (fingers.length === 1 ? fingers[0].name : ""),
    face: reading.face ?? undefined,
    wedge_angle_deg: reading.wedge_angle_deg ?? undefined,
    load_N: reading.load_N ?? undefined,
  };
}

export class NewFiles {
  constructor() {
    this.problem = h("div");
    this.study = workspace.study.name;
    /** What was entered for each file, kept over a reload until the file is used. */
    this.drafts = new Map(Object.entries(JSON.parse(localStorage.getItem(this.#key) ?? "{}")));
    /** @type {Map<string, Partial<Answers["UploadedFile"]>>} */
    this.info = new Map();
    this.shared = {};
    this.root = h("section.card.new-files", {
      hidden: true,
      "aria-label": "New files",
      oninput: () => setTimeout(() => this.#keep()),
      onchange: () => setTimeout(() => this.#keep()),
    });
    this.rest = h("details.card", { hidden: true });
  }

  get #key() {
    return `fingerpad.files.${this.study}`;
  }

  /** Keep what was entered. */
  #keep() {
    if (this.drafts.size) localStorage.setItem(this.#key, JSON.stringify(Object.fromEntries(this.drafts)));
    else localStorage.removeItem(this.#key);
  }

  /** Store what was found in uploaded files. */
  addInfo(files) {
    for (const each of files) this.info.set(each.file, each);
  }

  draw() {
    const unused = workspace.study.files.filter(({ used, kind }) => !used && kind !== "other");
    const files = unused.filter(({ file }) => file.startsWith("uploads/"));
    this.#drawRest(unused.filter(({ file }) => !file.startsWith("uploads/")));
    this.root.hidden = !files.length;
    if (!files.length) return;
    for (const each of files) {
      const { file, kind } = each;
      if (!this.drafts.has(file)) {
        this.drafts.set(file, draftOf(each));
        if (kind === "picture" && !this.info.has(file)) this.#loadInfo(file);
      }
    }
    this.files = files.map(({ file }) => file);
    for (const file of this.drafts.keys()) if (!this.files.includes(file)) this.drafts.delete(file);
    this.#keep();
    const shown = files.slice(0, 60);
    render(
      this.root,
      h(
        "header",
        null,
        h("h2", null, `${files.length} new file${files.length > 1 ? "s" : ""}`),
        h(
          "span.soft",
          null,
          "Enter what each file is. The values were read from the file names; correct them where needed.",
        ),
        h(
          "div.actions",
          null,
          button("Add to study", () => this.#use(), { kind: "primary" }),
        ),
      ),
      this.problem,
      this.#common(),
      h(
        "div.table-wrap",
        { tabindex: 0, role: "group", "aria-label": "New files" },
        h(
          "table",
          null,
          h(
            "thead",
            null,
            h(
              "tr",
              null,
              ["", "File", "Type", "Finger", "Face", "Wedge, °", "Load, N", "Scale", ""].map((words) =>
                h("th", { scope: "col" }, words),
              ),
            ),
          ),
          h(
            "tbody",
            null,
            shown.map((file) => this.#row(file)),
          ),
        ),
      ),
      files.length > shown.length &&
        h(
          "p.soft",
          null,
          `${files.length - shown.length} more files are not listed; "Add to study" adds all.`,
        ),
      check("These files are synthetic (rendered or simulated)", {
        checked: this.shared.synthetic,
        onset: (on) => (this.shared.synthetic = on),
      }),
      h(
        "datalist",
        { id: "fingers" },
        workspace.study.fingers.map(({ name }) => h("option", { value: name })),
      ),
    );
  }

  /** List unused files of the study folder that were not uploaded. */
  #drawRest(files) {
    this.rest.hidden = !files.length;
    render(
      this.rest,
      h(
        "summary",
        null,
        `${files.length} more file${files.length > 1 ? "s" : ""} in the study folder, not used`,
      ),
      h(
        "ul.rest",
        null,
        files
          .slice(0, 200)
          .map(({ file, bytes: size }) =>
            h("li", null, h("code", null, file), " ", h("span.soft.number", null, bytes(size))),
          ),
      ),
    );
  }

  async #loadInfo(file) {
    this.info.set(file, {});
    const info = await get("/api/picture/info", { item: `file:${file}` }).catch(() => null);
    if (info === null) return;
    this.info.set(file, info);
    const select = this.root.querySelector(`[data-field="${CSS.escape(`${file}:scale`)}"]`);
    if (select && info.resolution_ppi) select.replaceWith(this.#scale(file));
  }

  #common() {
    // in place: redrawing would remove the field that was just clicked
    const every = (key, value) => {
      this.shared[key] = value;
      for (const [file, draft] of this.drafts) {
        draft[key] = value;
        const control = this.root.querySelector(`[data-field="${CSS.escape(`${file}:${key}`)}"]`);
        if (control) control.value = value ?? "";
      }
    };
    const finger = text({
      value: this.shared.finger,
      placeholder: "e.g. left_index",
      list: "fingers",
      pattern: NAME,
      label: "Finger of all new files",
      onset: (value) => value && finger.checkValidity() && every("finger", value),
    });
    const scale = choose({
      value: this.shared.scale ?? "",
      options: [["", "–"], ...scaleNames()],
      label: "Scale of all new pictures",
      onset: (value) => value && every("scale", value),
    });
    const wedge = number({
      value: this.shared.wedge_angle_deg,
      min: 0,
      max: 90,
      label: "Wedge angle of all new files, degrees",
      onset: (value) => every("wedge_angle_deg", value ?? undefined),
    });
    return (
      this.drafts.size > 1 &&
      h(
        "div.common",
        null,
        h("span.soft", null, "All files:"),
        h("label", null, "finger", finger),
        h("label", null, "wedge °", wedge),
        h("label", null, "scale", scale),
      )
    );
  }

  #row({ file, kind, bytes: size }) {
    const draft = this.drafts.get(file);
    const put = (key) => (value) => (draft[key] = value ?? undefined);
    const name = file.split("/").at(-1);
    const as = choose({
      value: draft.as,
      options: KINDS[kind],
      label: `Type of ${name}`,
      onset: (value) => ((draft.as = value), redraw(() => this.draw())),
    });
    const finger = text({
      value: draft.finger,
      placeholder: "e.g. left_index",
      list: "fingers",
      pattern: NAME,
      label: `Finger on ${name}`,
      onset: put("finger"),
    });
    finger.addEventListener("input", () => (draft.finger = finger.value.trim()));
    const face = choose({
      value: draft.face ?? "",
      options: [["", "–"], ...FACES],
      label: `Face on ${name}`,
      onset: (value) => (draft.face = value || undefined),
    });
    const wedge = number({
      value: draft.wedge_angle_deg,
      min: 0,
      max: 90,
      label: `Wedge angle of ${name}, degrees`,
      onset: put("wedge_angle_deg"),
    });
    const load = number({
      value: draft.load_N,
      min: 0,
      label: `Load of ${name}, newtons`,
      onset: put("load_N"),
    });
    for (const [control, key] of [
      [finger, "finger"],
      [wedge, "wedge_angle_deg"],
    ])
      control.dataset.field = `${file}:${key}`;
    const placed = ["observation", "sequence", "curve"].includes(draft.as);
    return h(
      "tr",
      null,
      h(
        "td",
        null,
        kind === "picture"
          ? h("img.small-thumb", {
              src: picture("thumbnail", `file:${file}`),
              alt: "",
              loading: "lazy",
            })
          : h("span.chip", null, kind),
      ),
      h("td", null, h("strong", null, name), h("div.soft", null, this.#about(file, size))),
      h("td", null, as),
      h("td", null, draft.as && finger),
      h("td", null, ["photograph", "outline"].includes(draft.as) && face),
      h("td", null, placed && wedge),
      h("td", null, draft.as === "observation" && load),
      h("td", null, ["observation", "photograph", "sequence"].includes(draft.as) && this.#scale(file)),
      h(
        "td",
        null,
        button("×", () => this.#forget(file), { kind: "icon", label: `Remove ${name}` }),
      ),
    );
  }

  #about(file, size) {
    const info = this.info.get(file) ?? {};
    const parts = [bytes(size)];
    if (info.rows_px) parts.push(`${info.columns_px} × ${info.rows_px} px`);
    if (info.columns) parts.push(info.columns.join(", "));
    return parts.join(" · ");
  }

  #scale(file) {
    const draft = this.drafts.get(file);
    const ppi = this.info.get(file)?.resolution_ppi;
    const names = scaleNames();
    draft.scale ??= names.length === 1 ? names[0] : "";
    const options = [["", "– later –"], ...names.map((name) => [name, name])];
    if (ppi) options.push([`ppi:${ppi}`, `${Number(ppi.toFixed(1))} ppi (from file)`]);
    const select = choose({
      value: draft.scale,
      options,
      label: `Scale of ${file}`,
      onset: (value) => (draft.scale = value),
    });
    select.dataset.field = `${file}:scale`;
    return select;
  }

  async #forget(file) {
    const draft = this.drafts.get(file);
    try {
      const { removed } = await remove("/api/files", { file });
      toast(`${file.split("/").at(-1)} was removed.`, {
        kind: "good",
        action: { words: "Undo", do: () => this.#restore(removed, draft) },
        stays: true,
      });
    } catch (error) {
      showError(error);
    }
    await workspace.reload().catch(showError);
  }

  async #restore(removed, draft) {
    try {
      const { restored } = await post("/api/files/restore", { removed });
      this.drafts.set(restored, draft);
      toast(`${restored.split("/").at(-1)} was restored.`, { kind: "good" });
    } catch (error) {
      showError(error);
    }
    await workspace.reload().catch(showError);
  }

  async #use() {
    const wrong = this.root.querySelector("input:invalid");
    if (wrong) return wrong.reportValidity();
    /** @type {Edit[]} */
    const edits = [];
    const taken = new Set([
      ...workspace.study.observations.map(({ item }) => item),
      ...workspace.study.sequences.map(({ name }) => name),
    ]);
    const fingers = new Set(workspace.study.fingers.map(({ name }) => name));
    let curves = workspace.study.curves.length;
    for (const file of this.files) {
      const draft = this.drafts.get(file);
      if (!draft.as || !draft.finger) continue;
      const scale = draft.scale?.startsWith("ppi:")
        ? { ppi: Number(draft.scale.slice(4)) }
        : draft.scale || undefined;
      const synthetic = this.shared.synthetic || undefined;
      const said = (set) =>
        Object.fromEntries(Object.entries(set).filter(([, value]) => value !== undefined && value !== ""));
      if (!fingers.has(draft.finger) && ["photograph", "outline"].includes(draft.as)) {
        edits.push({ kind: "finger", key: draft.finger, set: {} });
        fingers.add(draft.finger);
      }
      let name = draft.name;
      for (let number = 2; taken.has(name); number += 1) name = `${draft.name}_${number}`;
      if (draft.as === "observation") {
        edits.push({
          kind: "observation",
          key: name,
          set: said({
            finger: draft.finger,
            file,
            wedge_angle_deg: draft.wedge_angle_deg,
            load_N: draft.load_N,
            scale,
            synthetic,
          }),
        });
        taken.add(name);
      } else if (draft.as === "photograph")
        edits.push({
          kind: "photograph",
          key: `${draft.finger}/${file}`,
          set: said({ face: draft.face, scale, synthetic }),
        });
      else if (draft.as === "outline")
        edits.push({
          kind: "photograph",
          key: `${draft.finger}/${file}`,
          set: said({ face: draft.face, outline: file, synthetic }),
        });
      else if (draft.as === "sequence") {
        const force = workspace.study.files.find(
          (other) => !other.used && other.kind === "table" && /force/i.test(other.file),
        )?.file;
        edits.push({
          kind: "sequence",
          key: name,
          set: said({
            finger: draft.finger,
            file,
            wedge_angle_deg: draft.wedge_angle_deg,
            scale,
            force,
            synthetic,
          }),
        });
        taken.add(name);
      } else if (draft.as === "curve")
        edits.push({
          kind: "curve",
          key: String(curves++),
          set: said({ finger: draft.finger, wedge_angle_deg: draft.wedge_angle_deg, file, synthetic }),
        });
    }
    render(this.problem);
    if (!edits.length) {
      render(
        this.problem,
        h("div.faults", { role: "alert" }, h("p", null, "Enter at least the finger of the files.")),
      );
      return undefined;
    }
    try {
      await workspace.edit(...edits);
      return toast(inUse(edits.filter(({ kind }) => kind !== "finger").length), { kind: "good" });
    } catch (error) {
      render(this.problem, faultList(error));
      return undefined;
    }
  }
}

const inUse = (count) => `${count} file${count === 1 ? "" : "s"} added.`;
