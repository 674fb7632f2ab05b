/** What a vehicle answered to an upload. */
import { h } from "../dom";
import { findingText } from "../notices";
import type { Upload } from "../types";
import { readiness } from "./readiness";

const DIFFERENCES_SHOWN = 8;
const WORDS: Record<Upload["outcome"], string> = {
  accepted: "The vehicle accepted it",
  different: "NOT DONE: the vehicle holds something else than was meant. Upload it again; do not fly it meanwhile",
  refused: "The vehicle refused it",
  unknown: "Outcome unknown: the vehicle did not answer to the end. It is read back as soon as it is heard again",
  not_attempted: "Not attempted",
};

/** One verdict: an upload is done only when what is held is what was meant. */
function verdict(result: Upload): { words: string; tone: "good" | "warning" | "error" } {
  if (result.outcome !== "accepted") return { words: `${WORDS[result.outcome]}.`, tone: result.outcome === "refused" || result.outcome === "different" ? "error" : "warning" };
  if (result.verified) return { words: `${WORDS.accepted}; read back equal.`, tone: "good" };
  return { words: `${WORDS.accepted}, but it could not be read back: what it holds is not known.`, tone: "warning" };
}

function partLine(name: string, part: Upload["parts"][string]): HTMLElement {
  const differing = part.differences?.length ?? 0;
  const compared = part.verified ? "read back equal" : part.differences === null ? "not read back" : `${differing} ${differing === 1 ? "difference" : "differences"}`;
  const lines = (part.differences ?? []).slice(0, DIFFERENCES_SHOWN).map((difference) => h("li", {}, difference.message));
  return h(
    "li",
    { class: part.verified ? "" : part.outcome === "accepted" || part.outcome === "unknown" ? "warning" : "error" },
    `${name}: ${part.meant} items, ${part.outcome.replace("_", " ")}, ${compared}${part.reason && part.reason !== part.outcome ? ` – ${part.reason}` : ""}`,
    lines.length > 0 ? h("ul", {}, ...lines, differing > lines.length ? h("li", {}, `and ${differing - lines.length} more`) : null) : null,
  );
}

/** `plan` is the one on the map, which may be another than was sent. */
export function uploadAnswer(result: Upload, plan: string | undefined): HTMLElement {
  const said = verdict(result);
  return h(
    "div",
    { "data-outcome": result.outcome, "data-verified": String(result.verified) },
    plan !== undefined && plan !== result.plan_id ? h("p", { class: "warning" }, "Another plan than the one on the map was sent:") : null,
    h("p", { class: said.tone }, said.words),
    h("ul", { class: "findings" }, ...Object.entries(result.parts).map(([name, part]) => partLine(name, part))),
    result.findings.length > 0 ? h("ul", { class: "findings" }, ...result.findings.map((finding) => h("li", { class: finding.severity ?? "warning" }, findingText(finding)))) : null,
    ...result.notes.map((note) => h("p", { class: "quiet" }, note)),
    result.preflight ? readiness(result.preflight) : null,
    result.override_reason ? h("p", { class: "warning" }, `Sent against the check's verdict: ${result.override_reason}`) : null,
  );
}
