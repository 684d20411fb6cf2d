// New files: what each of them is, entered one by one or for all.

import { get, post, removeFile } from "../core/api.js";
import { button, h, render, update } from "../core/dom.js";
import { ask, showError, toast } from "../core/messages.js";
import { bytes, counted } from "../core/quantity.js";
import { rules, workspace } from "../core/workspace.js";
import { check, faultList, thumbnail } from "../parts/forms.js";
import { scaleNames } from "../parts/scale_ways.js";
import { scrolled, tableOf } from "../parts/tables.js";
import { allRow, base, COIN, fileRow, guessesOf, takeGuess, takes } from "./new_files_row.js";
import { NewFileTools } from "./new_files_tools.js";

const COLUMNS = ["", "File", "Type", "Finger", "Face", "Wedge, °", "Load, N", "Scale", ""];
/** Columns whose values are often those of the file above. */
const FILLED = { Finger: "finger", Face: "face", "Wedge, °": "wedge_angle_deg", Scale: "scale" };
const LOOKED =
  "What each file is was read from its content and name. Correct it where needed, and enter what is empty.";

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
    /** A scale that is read now, for all files. */
    this.reading = Promise.resolve();
    /** What the file is that is looked at now. */
    this.now = Promise.resolve(null);
    /** Files that are looked at now, one after the other. */
    this.looking = Promise.resolve();
    this.toLookAt = 0;
    this.lookedAt = new Set();
    /** Files that no spreadsheet was joined to yet. */
    this.fresh = /** @type {string[]} */ ([]);
    this.tools = new NewFileTools({ files: () => this.entered(), take: (stated) => this.#take(stated) });
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
    return `fingerpad.drafts.${this.study}`;
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
      const { file, kind, reading } = each;
      if (!this.drafts.has(file)) this.drafts.set(file, { ...reading });
      if (kind === "picture" && !this.info.has(file)) this.#loadInfo(file);
      // Which scale may hold changes with the scales of the study.
      const looked = `${file} ${scaleNames().join()}`;
      if (this.drafts.get(file).looked !== looked && !this.lookedAt.has(looked)) this.#lookAt(file, looked);
    }
    const names = new Set(uploaded.map(({ file }) => file));
    for (const file of this.drafts.keys()) if (!names.has(file)) this.drafts.delete(file);
    this.keep();
    const isSheet = ({ file }) => this.drafts.get(file)?.use === "sheet";
    const files = uploaded.filter((each) => !isSheet(each));
    this.#drawRest(unused.filter((each) => !names.has(each.file) || isSheet(each)));
    this.files = files.map(({ file }) => file);
    this.root.hidden = !files.length;
    if (!files.length) return;
    this.#useCoin();
    const shown = files.slice(0, 60);
    this.status.textContent = this.toLookAt ? `Looking at ${counted(this.toLookAt, "file")} …` : LOOKED;
    update(this.root, [
      h("header", [
        h("h2", counted(files.length, "new file")),
        this.status,
        h("div.actions", [button("Add to study", () => this.#use(), { kind: "primary" })]),
      ]),
      this.problem,
      allRow(this),
      this.tools.root,
      scrolled(
        "New files",
        tableOf(
          "table",
          COLUMNS.map((words) =>
            h("th", { scope: "col" }, [
              words,
              words in FILLED &&
                files.length > 1 &&
                button("↓", () => this.#fillDown(FILLED[words]), {
                  kind: "icon",
                  label: `Fill down: ${words}`,
                  title: "Fill empty fields from the one above",
                }),
            ]),
          ),
          shown.map((file) => fileRow(this, file)),
        ),
      ),
      files.length > shown.length &&
        h("p.soft", `${files.length - shown.length} more files are not listed; "Add to study" adds all.`),
      check("These files are synthetic (rendered or simulated)", {
        checked: this.shared.synthetic ?? false,
        onset: (on) => (this.shared.synthetic = on),
      }),
      h("datalist", { id: "fingers" }, [
        workspace.study.fingers.map(({ name }) => h("option", { value: name })),
      ]),
      h("datalist", { id: "new-scales" }, [
        [...scaleNames(), "500 ppi", "1000 ppi", "0.05 mm/px"].map((value) => h("option", { value })),
      ]),
    ]);
  }

  /** What is known of the new files. */
  entered(files = this.files) {
    return files.map((file) => {
      const { touched, guess, looked, ...known } = this.drafts.get(file);
      return known;
    });
  }

  /** Find out what a file is, after those before it. */
  #lookAt(file, looked) {
    this.toLookAt += 1;
    this.lookedAt.add(looked);
    if (!this.drafts.get(file).looked) this.fresh.push(file);
    const look = async () => {
      const known = this.drafts.has(file); // else it was removed meanwhile
      this.now = known ? get("/files/identity", { file }).catch(() => null) : Promise.resolve(null);
      const guess = await this.now;
      const draft = this.drafts.get(file);
      this.toLookAt -= 1;
      if (guess && draft) {
        const shown = () => JSON.stringify([draft.use, draft.face, draft.scale, guessesOf(draft)]);
        const before = shown();
        Object.assign(draft, { guess, looked });
        takeGuess(draft);
        // What is as drawn stays: drawing again would drop a value that is being entered.
        this.different ||= shown() !== before;
      }
      if (this.toLookAt) return;
      const fresh = this.fresh.splice(0);
      const isSheet = (one) => this.drafts.get(one)?.use === "sheet";
      this.files = this.files.filter((one) => !isSheet(one));
      const wanted = this.files.filter((one) => fresh.includes(one));
      for (const sheet of [...this.drafts.keys()].filter(isSheet)) {
        if (fresh.includes(sheet)) await this.tools.join({ file: sheet });
        else if (wanted.length) await this.tools.join({ file: sheet }, this.entered(wanted), { quiet: true });
      }
      this.keep();
      if (this.different) this.changed();
      else this.status.textContent = LOOKED;
      this.different = false;
    };
    this.looking = this.looking.then(look).catch(showError);
  }

  /** Take what is stated of files into the drafts. */
  #take(stated) {
    for (const { file, values } of stated) Object.assign(this.drafts.get(file), values);
    this.draw();
  }

  /** Take the scale of the one coin for photographs that have none. */
  #useCoin() {
    const coins = this.files.filter((file) => this.drafts.get(file).use === "coin");
    const scale = coins.length === 1 && this.drafts.get(coins[0]).diameter_mm > 0 ? COIN + coins[0] : "";
    for (const file of this.files) {
      const draft = this.drafts.get(file);
      if (draft.scale.startsWith(COIN) && draft.scale !== scale) draft.scale = "";
      if (scale && draft.use === "photograph" && !draft.scale) draft.scale = scale;
    }
  }

  /** Fill the empty fields of a column from the field above them. */
  #fillDown(key) {
    let above;
    for (const file of this.files) {
      const draft = this.drafts.get(file);
      if (!takes(draft, key)) continue;
      if (draft[key] === undefined || draft[key] === null || draft[key] === "") draft[key] = above;
      else above = draft[key];
    }
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
    render(this.rest, [
      h("summary", `${counted(files.length, "more file")} in the study folder, not used`),
      h("ul.rest", [
        files
          .slice(0, 200)
          .map(({ file, bytes: size }) =>
            h("li", [
              h("code", file),
              " ",
              h("span.soft.number", bytes(size)),
              file.startsWith("uploads/") &&
                button("×", () => this.forget(file), { kind: "icon", label: `Remove ${base(file)}` }),
            ]),
          ),
      ]),
    ]);
  }

  async #loadInfo(file) {
    this.info.set(file, {});
    const info = await get("/picture/info", { item: `file:${file}` }).catch(() => null);
    if (info === null) return;
    this.info.set(file, info);
    if (this.drafts.has(file)) this.draw();
  }

  async forget(file) {
    const draft = this.drafts.get(file);
    this.drafts.delete(file);
    this.files = this.files.filter((one) => one !== file);
    await this.now; // it may be looked at
    try {
      const { removed } = await removeFile(file);
      toast(`${base(file)} was removed.`, {
        kind: "good",
        action: { words: "Undo", do: () => this.#restore(removed, draft) },
        stays: true,
      });
    } catch (error) {
      if (draft) this.drafts.set(file, draft);
      showError(error);
    }
    await workspace.reload().catch(showError);
  }

  async #restore(removed, draft) {
    try {
      const { file: restored } = await post("/files/restore", { removed });
      if (draft) this.drafts.set(restored, draft);
      toast(`${base(restored)} was restored.`, { kind: "good" });
    } catch (error) {
      showError(error);
    }
    await workspace.reload().catch(showError);
  }

  /** Ask whether the guesses are right; true if they are. */
  async #confirmed() {
    const open = this.files.map((file) => this.drafts.get(file)).filter((draft) => guessesOf(draft).length);
    if (!open.length) return true;
    const uses = Object.assign({}, ...Object.values(rules().uses));
    const right = await ask(
      open.length === 1 ? "Is this right?" : "Are these right?",
      h("ul.guesses", [
        open
          .slice(0, 30)
          .map((draft) =>
            h("li", [
              thumbnail(`file:${draft.file}`),
              h("strong", base(draft.file)),
              h("span", [
                uses[draft.use],
                draft.use === "photograph" && draft.face && `, ${draft.face} face`,
                guessesOf(draft).includes("scale") && `, ${draft.guess.scales[draft.use].why}`,
              ]),
            ]),
          ),
        open.length > 30 && h("li", `and ${open.length - 30} more`),
      ]),
      "Yes, add them",
      { no: "Change" },
    );
    if (!right) {
      const [draft] = open;
      const what = { use: "Type of", face: "Face on", scale: "Scale of" }[guessesOf(draft)[0]];
      this.root.querySelector(`select[aria-label="${CSS.escape(`${what} ${base(draft.file)}`)}"]`)?.focus();
      return false;
    }
    for (const draft of open) draft.guessed = [];
    return true;
  }

  async #use() {
    await Promise.all([this.looking, this.reading]);
    const wrong = this.root.querySelector("input:invalid");
    if (wrong) return wrong.reportValidity();
    if (!(await this.#confirmed())) return undefined;
    const asked = { files: this.entered(), synthetic: this.shared.synthetic ?? false };
    const found = await post("/files/edits", asked).catch((error) => error);
    if (found instanceof Error) return render(this.problem, faultList(found));
    const { edits, added, waiting } = found;
    render(this.problem);
    if (waiting.length) {
      const words = edits.length
        ? `${counted(waiting.length, "file")} not added yet: enter the finger.`
        : "Enter the finger of the files.";
      render(this.problem, faultList({ message: words }));
    }
    if (!edits.length) {
      if (waiting.length) this.root.querySelector(`input[aria-label^="Finger o"]`)?.focus();
      else toast("There is nothing to add: state what the files are.");
      return undefined;
    }
    try {
      await workspace.edit(...edits);
    } catch (error) {
      return render(this.problem, faultList(error));
    }
    if (!waiting.length) render(this.tools.report);
    const { missing } = workspace.study;
    const left =
      missing.length && `${missing.length === 1 ? "One entry is" : `${missing.length} entries are`} missing.`;
    return toast(left ? `${counted(added, "file")} added. ${left}` : `${counted(added, "file")} added.`, {
      kind: "good",
      ...(left && { action: { words: "Show", do: this.showMissing } }),
    });
  }
}
