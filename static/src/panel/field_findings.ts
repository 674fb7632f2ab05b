/** What the service finds wrong with a value, said beside the field it stands in. */
import { h } from "../dom";
import { findingWords } from "../notices";
import { scenarios } from "../scenario";
import type { Finding, Member } from "../types";

const OWNERS = [
  ["sensor ", "sensors"],
  ["vehicle ", "vehicles"],
] as const;

/** Members of the scenario with fields of their own. */
const MEMBERS: Record<string, string> = { wind: "wind", separation: "separation", search: "search", drift: "drift", objective: "w", method: "m" };

/** What the ids of fields begin with where what the finding is of is edited. */
function prefixOf(feature: string): string | null {
  if (feature === "scenario") return "s";
  if (MEMBERS[feature] !== undefined) return MEMBERS[feature];
  for (const [word, list] of OWNERS) {
    if (!feature.startsWith(word)) continue;
    const called = feature.slice(word.length);
    const index = (scenarios.document.value[list] as Member[] | undefined)?.findIndex((entry, i) => String(entry["name"] ?? i) === called) ?? -1;
    return index < 0 ? null : `${list}-${index}`;
  }
  return feature === scenarios.selection.value ? "f" : null;
}

/** The field that a finding is of: that of the first property it names which has one. */
export function fieldOf(finding: Finding): HTMLElement | null {
  const prefix = prefixOf(finding.feature);
  if (prefix === null) return null;
  for (const word of finding.message.split(/[^\w]+/)) {
    const field = word && document.getElementById(`${prefix}-${word}`);
    if (field) return field;
  }
  return null;
}

/** Show the field and go to it. */
export function goToField(field: HTMLElement): void {
  for (let above = field.parentElement; above; above = above.parentElement) if (above instanceof HTMLDetailsElement) above.open = true;
  field.focus();
  field.scrollIntoView({ block: "center" });
}

/** Put findings beside their fields in a form, and a mark on the sections that hold one. */
export function markFields(form: HTMLElement, findings: Finding[]): void {
  for (const said of form.querySelectorAll(".field-finding")) said.remove();
  for (const field of form.querySelectorAll("[data-found]")) {
    field.removeAttribute("data-found");
    if (!(field as HTMLInputElement).validationMessage) field.removeAttribute("aria-invalid");
    const others = (field.getAttribute("aria-describedby") ?? "").split(" ").filter((id) => !id.endsWith("-finding"));
    if (others.join("")) field.setAttribute("aria-describedby", others.join(" "));
    else field.removeAttribute("aria-describedby");
  }
  for (const summary of form.querySelectorAll("summary.wrong")) summary.classList.remove("wrong");
  for (const finding of findings) {
    const field = fieldOf(finding);
    if (!field || !form.contains(field) || field.dataset["found"]) continue;
    const severity = finding.severity ?? "error";
    const id = `${field.id}-finding`;
    field.dataset["found"] = severity;
    if (severity === "error") field.setAttribute("aria-invalid", "true");
    field.setAttribute("aria-describedby", [field.getAttribute("aria-describedby"), id].filter(Boolean).join(" "));
    field.closest(".field")?.append(h("span", { id, class: `field-finding ${severity}` }, findingWords(finding)));
    if (severity !== "error") continue;
    for (let above = field.parentElement; above && above !== form; above = above.parentElement) if (above instanceof HTMLDetailsElement) above.querySelector("summary")?.classList.add("wrong");
  }
}
