// Short messages in the corner, and questions that must be answered.

import { h, place, rememberFocus } from "./dom.js";

/** Say something for a while; errors, and what `stays`, stay until they are put away. */
export function say(words, { kind = "info", action, stays = kind === "error" } = {}) {
  const box = document.getElementById("messages");
  const message = h(
    `div.message.${kind}`,
    null,
    h("p", null, words),
    action &&
      h("button.link", { type: "button", onclick: () => (action.do(), message.remove()) }, action.words),
    h(
      "button.icon",
      { type: "button", "aria-label": "Close this message", onclick: () => message.remove() },
      "×",
    ),
  );
  box.append(message);
  while (box.children.length > 4) box.firstElementChild.remove();
  if (!stays) setTimeout(() => message.remove(), 4500);
  return message;
}

export const complain = (error) => error.name === "AbortError" || say(error.message, { kind: "error" });

/** Ask one thing; resolves to the value of the button, or null. Enter in a field presses the primary button. */
export function question(title, body, buttons) {
  const giveBack = rememberFocus();
  return new Promise((resolve) => {
    const dialog = h("dialog.question", {
      "aria-label": title,
      onclose: () => (dialog.remove(), giveBack(), resolve(dialog.returnValue || null)),
    });
    place(
      dialog,
      h("h2", null, title),
      h("div.body", null, body),
      h(
        "div.actions",
        null,
        buttons.map(([value, words, kind = ""]) =>
          h(
            "button",
            {
              class: kind,
              type: "button",
              autofocus: kind === "primary",
              onclick: () => dialog.close(value),
            },
            words,
          ),
        ),
      ),
    );
    const primary = buttons.find(([, , kind]) => kind === "primary");
    dialog.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" || !primary || !event.target.matches("input")) return;
      event.preventDefault();
      dialog.close(primary[0]);
    });
    document.body.append(dialog);
    dialog.showModal();
    dialog.querySelector(".body input, .body select")?.focus(); // what is asked is typed at once
  });
}
