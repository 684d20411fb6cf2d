// New files: what each of them is, entered one by one or for all.

import { get, picture, post, remove } from "../core/api.js";
import { h, render, update } from "../core/dom.js";
import { ask, showError, toast } from "../core/messages.js";
import { bytes } from "../core/quantity.js";
import { workspace } from "../core/workspace.js";
import { button, check, faultList, NAME, number, text } from "../parts/forms.js";
import { scaleNames } from "../parts/scale_choice.js";
import { tableOf } from "../parts/tables.js";
import {
  AS_OF_CONTENT,
  draftOf,
  editsOf,
  guessedScaleWords,
  isNewScale,
  newScaleWords,
  parseScale,
  takeValues,
} from "./new_files_edits.js";
import { base, fileRow, KINDS, scaleAsked, takeFace, takes } from "./new_files_row.js";
import { NewFileTools } from "./new_files_tools.js";

const COLUMNS = [
  ["", ""],
  ["File", ""],
  ["Type", ""],
  ["Finger", "finger"],
  ["Face", "face"],
  ["Wedge, °", "wedge_angle_deg"],
  ["Load, N", ""],
  ["Scale", "scale"],
  ["", ""],
];
const LOOKED =
  "What each file is was read from its content and name. Correct it where needed, and enter what is empty.";
const plural = (count) => `${count} file${count === 1 ? "" : "s"}`;

export class NewFiles {
  /**
   * @param {{ changed: () => void, showMissing: () => void }} options what draws the view once files are
   *   identified, and what goes to the missing entries
   */
  constructor({ changed, showMissing }) {
    this.changed = changed;
    this.showMissing = showMissing;
    this.problem = h("div");
    this.status = h("span.soft", { role: "status" });
    /** Files that are looked at now, one after the other. */
    this.looking = Promise.resolve();
    this.toLookAt = 0;
    this.lookedAt = new Set();
    /** Files that no spreadsheet was joined to yet. */
    this.fresh = /** @type {string[]} */ ([]);
    this.tools = new NewFileTools({ files: () => this.files, take: (stated) => this.#take(stated) });
    this.study = workspace.study.name;
    /** What was entered for each file, kept over a reload until the file is used. */
    this.drafts = new Map(Object.entries(JSON.parse(localStorage.getItem(this.#key) ?? "{}")));
    /** @type {Map<string, Partial<Answers["UploadedFile"]>>} */
    this.info = new Map();
    this.shared = {};
    this.root = h("section.card.new-files", {
      hidden: true,
      "aria-label": "New files",
      oninput: () => setTimeout(() => this.keep()),
      onchange: () => setTimeout(() => this.keep()),
    });
    this.root.addEventListener("paste", (event) => this.#pasted(event), true);
    this.rest = h("details.card", { hidden: true });
  }

  get #key() {
    return `fingerpad.files.${this.study}`;
  }

  /** Keep what was entered. */
  keep() {
    if (this.drafts.size) localStorage.setItem(this.#key, JSON.stringify(Object.fromEntries(this.drafts)));
    else localStorage.removeItem(this.#key);
  }

  /** Store what was found in uploaded files. */
  addInfo(files) {
    for (const each of files) this.info.set(each.file, each);
  }

  draw() {
    const unused = workspace.study.files.filter(({ used, kind }) => !used && kind !== "other");
    const uploaded = unused.filter(({ file }) => file.startsWith("uploads/"));
    for (const each of uploaded) {
      const { file, kind } = each;
      if (!this.drafts.has(file)) this.drafts.set(file, draftOf(each));
      if (kind === "picture" && !this.info.has(file)) this.#loadInfo(file);
      if (!this.drafts.get(file).guesses && !this.lookedAt.has(file)) this.#lookAt(file);
    }
    const names = new Set(uploaded.map(({ file }) => file));
    for (const file of this.drafts.keys()) if (!names.has(file)) this.drafts.delete(file);
    this.keep();
    const isSheet = ({ file }) => this.drafts.get(file)?.as === "sheet";
    const files = uploaded.filter((each) => !isSheet(each));
    this.#drawRest(unused.filter((each) => !names.has(each.file) || isSheet(each)));
    this.files = files.map(({ file }) => file);
    this.root.hidden = !files.length;
    if (!files.length) return;
    this.#useCoin();
    for (const file of this.files) this.#guessScale(file);
    const shown = files.slice(0, 60);
    this.status.textContent = this.toLookAt ? `Looking at ${plural(this.toLookAt)} …` : LOOKED;
    update(
      this.root,
      h(
        "header",
        h("h2", `${files.length} new file${files.length > 1 ? "s" : ""}`),
        this.status,
        h(
          "div.actions",
          button("Add to study", () => this.#use(), { kind: "primary" }),
        ),
      ),
      this.problem,
      this.#common(),
      this.tools.root,
      h(
        "div.table-wrap",
        { tabindex: 0, role: "group", "aria-label": "New files" },
        tableOf(
          "table",
          COLUMNS.map(([words, key]) =>
            h(
              "th",
              { scope: "col" },
              words,
              key &&
                files.length > 1 &&
                button("↓", () => this.#fillDown(key), {
                  kind: "icon",
                  label: `Fill down: ${words}`,
                  title: "Fill empty fields from the one above",
                }),
            ),
          ),
          shown.map((file) => fileRow(this, file)),
        ),
      ),
      files.length > shown.length &&
        h("p.soft", `${files.length - shown.length} more files are not listed; "Add to study" adds all.`),
      check("These files are synthetic (rendered or simulated)", {
        checked: this.shared.synthetic,
        onset: (on) => (this.shared.synthetic = on),
      }),
      h(
        "datalist",
        { id: "fingers" },
        workspace.study.fingers.map(({ name }) => h("option", { value: name })),
      ),
      h(
        "datalist",
        { id: "new-scales" },
        [...scaleNames(), "500 ppi", "1000 ppi", "0.05 mm/px"].map((value) => h("option", { value })),
      ),
    );
  }

  /** Find out what a file is, after those before it. */
  #lookAt(file) {
    this.toLookAt += 1;
    this.lookedAt.add(file);
    this.fresh.push(file);
    const look = async () => {
      const guess = await get("/files/identity", { file }).catch(() => null);
      const draft = this.drafts.get(file);
      this.toLookAt -= 1;
      if (guess && draft) {
        const before = JSON.stringify([draft.as, draft.face]);
        draft.guesses = guess.contents.map((content) => AS_OF_CONTENT[content]);
        if (!draft.touched) Object.assign(draft, { as: draft.guesses[0], asked: !guess.sure });
        draft.faceGuess = { face: guess.faces[0], faceAsked: !guess.face_sure };
        takeFace(draft);
        // What is as drawn stays: drawing again would drop a value that is being entered.
        this.different ||=
          draft.asked || draft.faceAsked || JSON.stringify([draft.as, draft.face]) !== before;
      }
      if (this.toLookAt) return;
      const fresh = this.fresh.splice(0);
      const isSheet = (one) => this.drafts.get(one)?.as === "sheet";
      this.files = this.files.filter((one) => !isSheet(one));
      const wanted = this.files.filter((one) => fresh.includes(one));
      for (const sheet of [...this.drafts.keys()].filter(isSheet)) {
        if (fresh.includes(sheet)) await this.tools.join({ file: sheet }, this.files);
        else if (wanted.length) await this.tools.join({ file: sheet }, wanted, { quiet: true });
      }
      this.keep();
      if (this.different) this.changed();
      else this.status.textContent = LOOKED;
      this.different = false;
    };
    this.looking = this.looking.then(look).catch(showError);
  }

  /** Take stated values into the drafts; return what cannot be taken. */
  #take(stated) {
    const problems = stated
      .map(({ file, values }) => [file, takeValues(this.drafts.get(file), values)])
      .filter(([, problem]) => problem)
      .map(([file, problem]) => `${base(file)}: ${problem}`);
    this.keep();
    this.draw();
    return problems;
  }

  /** Take the scale of the one coin for photographs that have none. */
  #useCoin() {
    const coins = this.files.filter((file) => this.drafts.get(file).as === "coin");
    const scale = coins.length === 1 && this.drafts.get(coins[0]).diameter_mm > 0 ? `coin:${coins[0]}` : "";
    for (const file of this.files) {
      const draft = this.drafts.get(file);
      if (draft.scale?.startsWith("coin:") && !coins.includes(draft.scale.slice(5))) draft.scale = "";
      if (scale && draft.as === "photograph" && !draft.scale) draft.scale = scale;
    }
  }

  /** Fill the empty fields of a column from the field above them. */
  #fillDown(key) {
    let above;
    for (const file of this.files) {
      const draft = this.drafts.get(file);
      if (!takes(draft, key)) continue;
      if (draft[key] === undefined || draft[key] === "") draft[key] = above;
      else above = draft[key];
    }
    this.keep();
    this.draw();
  }

  /** Join cells of a spreadsheet that are pasted anywhere here; a single column is for the field. */
  #pasted(event) {
    const words = event.clipboardData.getData("text");
    if (!/\t/.test(words) || !/\n/.test(words.trim()) || event.target.matches("textarea")) return;
    event.preventDefault();
    event.stopPropagation();
    this.tools.join({ text: words });
  }

  /** List unused files of the study folder that were not uploaded. */
  #drawRest(files) {
    this.rest.hidden = !files.length;
    render(
      this.rest,
      h("summary", `${files.length} more file${files.length > 1 ? "s" : ""} in the study folder, not used`),
      h(
        "ul.rest",
        files
          .slice(0, 200)
          .map(({ file, bytes: size }) =>
            h(
              "li",
              h("code", file),
              " ",
              h("span.soft.number", bytes(size)),
              file.startsWith("uploads/") &&
                button("×", () => this.forget(file), { kind: "icon", label: `Remove ${base(file)}` }),
            ),
          ),
      ),
    );
  }

  async #loadInfo(file) {
    this.info.set(file, {});
    const info = await get("/picture/info", { item: `file:${file}` }).catch(() => null);
    if (info === null) return;
    this.info.set(file, info);
    if (this.drafts.has(file)) this.draw();
  }

  #common() {
    const every = (key, value) => {
      this.shared[key] = value;
      for (const draft of this.drafts.values()) draft[key] = value;
      this.draw();
    };
    const finger = text({
      value: this.shared.finger,
      placeholder: "e.g. left_index",
      list: "fingers",
      pattern: NAME,
      label: "Finger of all new files",
      onset: (value, input) => value && input.checkValidity() && every("finger", value),
    });
    const scaleFor = (as, words, placeholder) => {
      if (!this.files.some((file) => this.drafts.get(file).as === as)) return null;
      const control = text({
        value: this.shared[`scale_${as}`],
        placeholder,
        list: "new-scales",
        label: `Scale of all new ${words}`,
        onset: (value, field) => {
          const scale = value && parseScale(value);
          field.setCustomValidity(
            value && !scale ? "As in 500 ppi or 0.05 mm/px, or the name of a scale of the study" : "",
          );
          if (!field.reportValidity()) return;
          this.shared[`scale_${as}`] = isNewScale(scale) ? newScaleWords(scale) : value;
          for (const draft of this.drafts.values())
            if (draft.as === as) Object.assign(draft, { scale, scaleGuess: undefined });
          this.keep();
          this.draw();
        },
      });
      return h("label", `scale of ${words}`, control);
    };
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
        h("span.soft", "All files:"),
        h("label", "finger", finger),
        h("label", "wedge °", wedge),
        scaleFor("observation", "contact images", "e.g. 500 ppi"),
        scaleFor("photograph", "photographs", "e.g. 0.05 mm/px"),
      )
    );
  }

  /**
   * Propose a scale where none is stated: the only one of the study, or that in a contact image's file. A
   * resolution is a scanner's, and no photograph's.
   */
  #guessScale(file) {
    const draft = this.drafts.get(file);
    if (draft.scale !== undefined && draft.scale !== draft.scaleGuess) return;
    const { scales } = workspace.study;
    const ppi = this.info.get(file)?.resolution_ppi;
    const [only] = scales.length === 1 ? scales : [];
    const scanned = only && (only.table.ppi !== undefined || only.table.mm_per_px !== undefined);
    let guess = only && !(draft.as === "photograph" && scanned) ? only.name : "";
    // Programs that know no resolution write 72 or 96; a camera's says nothing of the finger.
    if (!guess && draft.as === "observation" && ppi > 96)
      guess = scales.find(({ table }) => Math.abs(Number(table.ppi) - ppi) < 0.1)?.name ?? `ppi:${ppi}`;
    Object.assign(draft, { scale: guess, scaleGuess: guess });
  }

  async forget(file) {
    const draft = this.drafts.get(file);
    try {
      const { removed } = await remove("/files", { file });
      toast(`${base(file)} was removed.`, {
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
      const { restored } = await post("/files/restore", { removed });
      if (draft) this.drafts.set(restored, draft);
      toast(`${base(restored)} was restored.`, { kind: "good" });
    } catch (error) {
      showError(error);
    }
    await workspace.reload().catch(showError);
  }

  /** Ask whether the guesses are right; true if they are. */
  async #confirmed() {
    const open = this.files
      .map((file) => ({ file, draft: this.drafts.get(file) }))
      .filter(
        ({ draft }) => draft.asked || (draft.as === "photograph" && draft.faceAsked) || scaleAsked(draft),
      );
    if (!open.length) return true;
    const kinds = Object.fromEntries(Object.values(KINDS).flat());
    const right = await ask(
      open.length === 1 ? "Is this right?" : "Are these right?",
      h(
        "ul.guesses",
        open
          .slice(0, 30)
          .map(({ file, draft }) =>
            h(
              "li",
              h("img.small-thumb", { src: picture("thumbnail", `file:${file}`), alt: "" }),
              h("strong", base(file)),
              h(
                "span",
                kinds[draft.as],
                draft.as === "photograph" && draft.face && `, ${draft.face} face`,
                scaleAsked(draft) && `, ${guessedScaleWords(draft.scale)}`,
              ),
            ),
          ),
        open.length > 30 && h("li", `and ${open.length - 30} more`),
      ),
      "Yes, add them",
      { no: "Change" },
    );
    if (!right) {
      const { file, draft } = open[0];
      const face = draft.as === "photograph" && draft.faceAsked;
      const what = draft.asked ? "Type of" : face ? "Face on" : "Scale of";
      this.root.querySelector(`select[aria-label="${CSS.escape(`${what} ${base(file)}`)}"]`)?.focus();
      return false;
    }
    for (const { draft } of open)
      Object.assign(draft, { asked: false, faceAsked: false, scaleGuess: undefined });
    return true;
  }

  async #use() {
    const wrong = this.root.querySelector("input:invalid");
    if (wrong) return wrong.reportValidity();
    await this.looking;
    if (!(await this.#confirmed())) return undefined;
    const { edits, added, waiting } = editsOf(this.files, this.drafts, this.shared);
    render(this.problem);
    if (waiting.length) {
      const words = edits.length
        ? `${plural(waiting.length)} not added yet: enter the finger.`
        : "Enter the finger of the files.";
      render(this.problem, h("div.faults", { role: "alert" }, h("p", words)));
    }
    if (!edits.length) {
      if (waiting.length) this.root.querySelector(`input[aria-label^="Finger o"]`)?.focus();
      else toast("There is nothing to add: state what the files are.");
      return undefined;
    }
    try {
      await workspace.edit(...edits);
      if (!waiting.length) render(this.tools.report);
      const { missing } = workspace.study;
      const left =
        missing.length &&
        `${missing.length === 1 ? "One entry is" : `${missing.length} entries are`} missing.`;
      return toast(left ? `${plural(added)} added. ${left}` : `${plural(added)} added.`, {
        kind: "good",
        ...(left && { action: { words: "Show", do: this.showMissing } }),
      });
    } catch (error) {
      render(this.problem, faultList(error));
      return undefined;
    }
  }
}
