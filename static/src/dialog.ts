/** Questions that must be answered before something flies. */
import { button, h } from "./dom";

interface Question {
  title: string;
  lines: string[];
  /** Label of the button that goes on. */
  go: string;
  /** Ask for a reason in words; going on needs one. */
  reason?: string;
}

/** Ask; resolves to null when the operator steps back, else to the reason given (empty when none was asked). */
export function ask(question: Question): Promise<string | null> {
  return new Promise((resolve) => {
    const reason = h("textarea", { id: "reason", rows: 2 });
    const finish = (answer: string | null): void => {
      dialog.close();
      dialog.remove();
      resolve(answer);
    };
    const go = button(question.go, () => finish(question.reason ? reason.value.trim() : ""), { class: question.reason ? "danger" : "primary", id: "dialog-go" });
    const enough = (): void => {
      go.disabled = question.reason !== undefined && reason.value.trim() === "";
    };
    reason.addEventListener("input", enough);
    enough();
    const dialog = h(
      "dialog",
      { "aria-labelledby": "dialog-title" },
      h("h2", { id: "dialog-title" }, question.title),
      question.lines.length === 1 ? h("p", {}, question.lines[0]) : h("ul", {}, ...question.lines.map((line) => h("li", {}, line))),
      question.reason ? h("label", { for: "reason" }, question.reason) : null,
      question.reason ? reason : null,
      h("div", { class: "row" }, button("Cancel", () => finish(null), { autofocus: true }), go),
    );
    dialog.addEventListener("cancel", () => finish(null));
    document.body.append(dialog);
    dialog.showModal();
  });
}

/** Ask which of several; the first is the usual one. Resolves to null when the operator steps back. */
export function choose(title: string, words: string, choices: readonly (readonly [id: string, label: string])[]): Promise<string | null> {
  return new Promise((resolve) => {
    const finish = (answer: string | null): void => {
      dialog.close();
      dialog.remove();
      resolve(answer);
    };
    const buttons = choices.map(([id, label], index) => button(label, () => finish(id), { id: `dialog-${id}`, class: index === 0 ? "primary" : "" }));
    const dialog = h("dialog", { "aria-labelledby": "dialog-title" }, h("h2", { id: "dialog-title" }, title), h("p", {}, words), h("div", { class: "row" }, ...buttons, button("Cancel", () => finish(null))));
    dialog.addEventListener("cancel", () => finish(null));
    document.body.append(dialog);
    dialog.showModal();
  });
}
