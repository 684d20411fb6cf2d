// Upload of files that are dropped on the page or chosen, one after the other.

import { send } from "../core/api.js";
import { button, h, render } from "../core/dom.js";
import { showError, toast } from "../core/messages.js";
import { workspace } from "../core/workspace.js";

/** Files of a drop, with the folder of each: the frames of a sequence are dropped as one folder. */
async function filesOf(transfer) {
  const entries = [...transfer.items].map((item) => item.webkitGetAsEntry?.()).filter(Boolean);
  if (!entries.some((entry) => entry.isDirectory)) return [...transfer.files].map((file) => ({ file }));
  /** @type {{ file: File, folder?: string }[]} */
  const found = [];
  const take = async (entry, folder = undefined) =>
    found.push({ file: await new Promise((done, failed) => entry.file(done, failed)), folder });
  for (const entry of entries) {
    if (entry.isFile) await take(entry);
    else {
      const reader = entry.createReader();
      const some = () => new Promise((done, failed) => reader.readEntries(done, failed));
      // A browser gives a folder's files some at a time, and none at the end.
      for (let read = await some(); read.length; read = await some())
        for (const each of read) if (each.isFile) await take(each, entry.name);
    }
  }
  return found.sort((a, b) => a.file.name.localeCompare(b.file.name, "en", { numeric: true }));
}

export class Drop {
  constructor({ sent }) {
    this.sent = sent;
    this.chooser = h("input", {
      type: "file",
      multiple: true,
      hidden: true,
      tabindex: -1,
      "aria-label": "Files to add",
      onchange: () => this.send([...this.chooser.files].map((file) => ({ file }))),
    });
    this.progress = h("div.sending", { role: "status", "aria-live": "polite" });
    this.root = h("div.drop", [
      h("div", [
        h("strong", "Drop photographs, contact images, sequences and curves here"),
        h(
          "p.soft",
          "PNG, JPEG, TIFF (8 or 16 bit), a folder of frames; curves and forces as CSV, XLSX, MAT " +
            "or TDMS; a spreadsheet (CSV, XLSX) that says what they are. Files stay on this computer.",
        ),
      ]),
      button("Choose files", () => this.chooser.click(), { kind: "primary" }),
      this.chooser,
      this.progress,
    ]);
  }

  /** Accept drops anywhere on the page; return what ends it. */
  watch() {
    const over = (on) => this.root.classList.toggle("over", on);
    const ended = new AbortController();
    const on = (type, does) => window.addEventListener(type, does, ended);
    on("dragover", () => over(true));
    on("dragleave", () => over(false));
    on("drop", async (event) => {
      over(false);
      this.send(await filesOf(event.dataTransfer).catch((error) => (showError(error), [])));
    });
    return () => ended.abort();
  }

  async send(files) {
    const kept = [];
    const refused = [];
    for (const [index, { file, folder }] of files.entries()) {
      const bar = h("progress", { max: 1, value: 0, "aria-label": `Sending ${file.name}` });
      render(this.progress, [h("span", `${index + 1} of ${files.length}: ${file.name}`), bar]);
      try {
        kept.push(await send("/files", { name: file.name, folder }, file, (share) => (bar.value = share)));
      } catch (error) {
        refused.push(`${file.name}: ${error.message}`);
      }
    }
    this.chooser.value = "";
    render(this.progress);
    if (refused.length) toast(refused.slice(0, 5).join("\n"), { kind: "error" });
    await workspace.reload().catch(showError);
    const used = new Set(workspace.study?.files.filter((each) => each.used).map((each) => each.file));
    const again = kept.filter(({ file }) => used.has(file));
    if (again.length)
      toast(`Already in the study: ${again.map(({ file }) => file.split("/").at(-1)).join(", ")}.`);
    if (kept.length) this.sent(kept);
  }
}
