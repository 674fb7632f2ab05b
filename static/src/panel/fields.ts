/** Form fields bound to a value somewhere else: shown by `sync`, written back when the operator is done. */
import { fill, h } from "../dom";
import type { Signal } from "../signal";

export interface Field {
  element: HTMLElement;
  /** Show the value as it is now, unless the operator is just typing. */
  sync(): void;
}

interface Common<T> {
  id: string;
  label: string;
  hint?: string;
  get(): T | undefined;
  set(value: T | undefined): void;
}

/** Labels by the ids of their fields, whichever aircraft or sensor it is of. */
const LABELS = new Map<string, string>();
const anyOf = (id: string): string => id.replace(/^(vehicles|sensors)-\d+-/, "$1-");

/** What a field is called in its form, without its unit; undefined where no form has shown it yet. */
export const labelOf = (id: string): string | undefined => LABELS.get(anyOf(id));

function labelled(id: string, label: string, control: HTMLElement, hint?: string): HTMLElement {
  if (hint) control.setAttribute("aria-describedby", `${id}-hint`);
  LABELS.set(anyOf(id), label.replace(/ \([^)]*\)$/, ""));
  return h(
    "div",
    { class: "field", title: hint },
    h("label", { for: id, class: hint ? "hinted" : "" }, label),
    control,
    hint ? h("span", { id: `${id}-hint`, class: "sr-only" }, hint) : null,
  );
}

function sayInvalid(control: HTMLInputElement | HTMLTextAreaElement, message: string): void {
  control.setCustomValidity(message);
  control.setAttribute("aria-invalid", String(message !== ""));
  if (message) control.reportValidity();
}

export function numberField(options: Common<number> & { unit?: string; min?: number; max?: number; required?: boolean; placeholder?: string }): Field {
  const { id, get, set } = options;
  const input = h("input", { id, type: "number", step: "any", min: options.min, max: options.max, placeholder: options.placeholder });
  input.addEventListener("change", () => {
    sayInvalid(input, "");
    const text = input.value.trim();
    if (text === "" && !input.validity.badInput) {
      if (options.required) sayInvalid(input, "A number is needed here.");
      else set(undefined);
    } else if (input.checkValidity()) {
      set(Number(text));
    } else {
      input.reportValidity();
    }
  });
  const shown = options.unit ? `${options.label} (${options.unit})` : options.label;
  return {
    element: labelled(id, shown, input, options.hint),
    sync: () => {
      if (document.activeElement === input) return;
      const value = get();
      input.value = value === undefined || value === null ? "" : String(value);
    },
  };
}

export function textField(options: Common<string> & { placeholder?: string; refuse?(text: string): string }): Field {
  const { id, get, set } = options;
  const input = h("input", { id, type: "text", placeholder: options.placeholder, autocomplete: "off", spellcheck: "false" });
  input.addEventListener("change", () => {
    const text = input.value.trim();
    const refusal = options.refuse?.(text) ?? "";
    sayInvalid(input, refusal);
    if (!refusal) set(text === "" ? undefined : text);
  });
  return {
    element: labelled(id, options.label, input, options.hint),
    sync: () => {
      if (document.activeElement !== input) input.value = get() ?? "";
    },
  };
}

/** A text for which the browser shows what of a list fits while it is being typed. */
export function suggestField<T extends { name: string }>(
  options: Common<string> & { placeholder?: string; wide?: boolean; suggestions: Signal<T[]>; words(entry: T): string; refuse(text: string): string },
): Field {
  const { id, get, set } = options;
  const choices = h("datalist", { id: `${id}-list` });
  const input = h("input", { id, type: "text", list: choices.id, placeholder: options.placeholder, autocomplete: "off", spellcheck: "false" });
  options.suggestions.watch((entries) => fill(choices, ...entries.map((entry) => h("option", { value: entry.name }, options.words(entry)))));
  input.addEventListener("change", () => {
    const text = input.value.trim();
    const refusal = options.refuse(text);
    sayInvalid(input, refusal);
    if (!refusal) set(text === "" ? undefined : text);
  });
  const element = labelled(id, options.label, input, options.hint);
  element.append(choices);
  element.classList.toggle("wide", options.wide ?? false);
  return {
    element,
    sync: () => {
      if (document.activeElement !== input) input.value = get() ?? "";
    },
  };
}

export function choiceField(options: Common<string> & { choices: readonly (string | readonly [string, string])[] }): Field {
  const { id, get, set } = options;
  const select = h("select", { id });
  for (const choice of options.choices) {
    const [value, label] = typeof choice === "string" ? [choice, choice] : choice;
    select.append(h("option", { value }, label));
  }
  select.addEventListener("change", () => set(select.value));
  return {
    element: labelled(id, options.label, select, options.hint),
    sync: () => {
      const value = get() ?? "";
      if (![...select.options].some((option) => option.value === value)) select.append(h("option", { value }, value || "–"));
      select.value = value;
    },
  };
}

export function tickField(options: Common<boolean>): Field {
  const { id, get, set } = options;
  const input = h("input", { id, type: "checkbox" });
  LABELS.set(anyOf(id), options.label);
  input.addEventListener("change", () => set(input.checked));
  return {
    element: h("div", { class: "field tick", title: options.hint }, input, h("label", { for: id }, options.label)),
    sync: () => {
      input.checked = get() ?? false;
    },
  };
}

export function areaField(options: Common<string> & { rows: number; refuse(text: string): string }): Field {
  const { id, get, set } = options;
  const input = h("textarea", { id, rows: options.rows, spellcheck: "false" });
  input.addEventListener("change", () => {
    const refusal = options.refuse(input.value);
    sayInvalid(input, refusal);
    if (!refusal) set(input.value);
  });
  return {
    element: h("div", { class: "field wide", title: options.hint }, h("label", { for: id }, options.label), input),
    sync: () => {
      if (document.activeElement !== input) input.value = get() ?? "";
    },
  };
}
