/** The parts of the flight with their lengths and times. */
import { h } from "../dom";
import { PHASE_WORDS, phasesOf } from "../phases";
import type { PlanCollection } from "../types";
import { metres, seconds } from "../units";

export function phaseTable(plan: PlanCollection): HTMLElement {
  const phases = phasesOf(plan);
  if (phases.length === 0) return h("p", { class: "warning", id: "phases" }, "Length and time are of the mission alone: take-off, climb, return and landing are drawn, but not counted in them.");
  const several = new Set(phases.map(({ vehicle }) => vehicle)).size > 1;
  return h(
    "table",
    { class: "compare", id: "phases" },
    h("thead", {}, h("tr", {}, ...[...(several ? ["Aircraft"] : []), "Part", "Length", "Time", "Ends at"].map((label) => h("th", { scope: "col" }, label)))),
    h(
      "tbody",
      {},
      ...phases.map((phase) =>
        h(
          "tr",
          {},
          several ? h("td", {}, phase.vehicle) : null,
          h("td", { class: "what" }, PHASE_WORDS[phase.kind] ?? phase.kind),
          h("td", {}, metres(phase.end_m - phase.start_m)),
          h("td", {}, seconds(phase.end_s - phase.start_s)),
          h("td", {}, seconds(phase.end_s)),
        ),
      ),
    ),
  );
}
