/** The planning side of the panel: start, progress, results, violations, files, earlier plans. */
import { ask } from "../dialog";
import { button, fill, h, section } from "../dom";
import { attempt, findingText } from "../notices";
import { cancelPlan, open, openPlan, planUrl, problemOf, recent, refresh, running, startPlan, type OpenPlan } from "../plans";
import { scenarios } from "../scenario";
import { readFindings } from "../api";
import type { PlanRecord, Position, Problem, Violation } from "../types";
import { metres, number, percent, seconds } from "../units";
import { judgement } from "../validation";
import { comparison } from "./compare";
import { operatingStrip } from "./strip";

export interface PlanView {
  zoomToPlace(place: Position): void;
  zoomToAll(): void;
}

const FILES = [
  ["plan.geojson", "Plan (GeoJSON)"],
  ["mission.plan", "QGroundControl"],
  ["mission.waypoints", "Waypoints"],
  ["mission.kml", "KML"],
] as const;
const MOVING = new Set(["queued", "running"]);
const RECENT_SHOWN = 12;
const COVERED = 0.9999;

function failure(problem: Problem, view: PlanView): HTMLElement {
  return h(
    "ul",
    { class: "findings", id: "failure" },
    h("li", { class: "error" }, [problem.title, problem.detail].filter(Boolean).join(": ")),
    ...readFindings(problem.errors).map((finding) => {
      const { where } = finding;
      const text = findingText(finding);
      return h("li", { class: "error" }, where ? button(text, () => view.zoomToPlace(where), { class: "link", title: "Show on the map" }) : text);
    }),
  );
}

/** Bar, stage and cancel button; they stay the same elements, so that a click or the focus is never lost. */
function progress(view: PlanView): HTMLElement {
  const bar = h("progress", { max: 1, "aria-label": "Planning progress" });
  const words = h("p", { role: "status" });
  const cancel = button("Cancel planning", () => void attempt("The plan was not cancelled", cancelPlan), { class: "danger", id: "plan-cancel" });
  const reasons = h("div", {});
  const box = h("div", { id: "progress" }, bar, words, reasons, cancel);
  running.watch((record) => {
    box.hidden = record === null;
    if (!record) return;
    const fraction = Math.min(1, Math.max(0, record.progress ?? 0));
    const problem = problemOf(record);
    const moving = MOVING.has(record.state);
    bar.hidden = !moving;
    cancel.hidden = !moving;
    bar.value = fraction;
    const text = moving ? `${record.stage ?? record.state} – ${percent(fraction, 0)}` : `Plan ${record.state}`;
    if (words.textContent !== text) words.textContent = text;
    fill(reasons, problem && record.state === "failed" ? failure(problem, view) : null);
  });
  return box;
}

function violations(found: Violation[], view: PlanView): HTMLElement {
  if (found.length === 0) return h("p", { class: "good" }, "The independent check found no violation.");
  return h(
    "ul",
    { class: "findings", id: "violations" },
    ...found.map((violation) => {
      const text = `${violation.hard ? "" : "(soft) "}${violation.feature}: ${violation.message} – ${violation.constraint}, by ${number(violation.amount, 2, violation.unit)}`;
      const { where } = violation;
      return h("li", { class: violation.hard ? "error" : "warning" }, where ? button(text, () => view.zoomToPlace(where), { class: "link", title: "Show on the map" }) : text);
    }),
  );
}

function table(rows: [string, string][], id?: string): HTMLElement {
  return h("table", { id }, h("tbody", {}, ...rows.map(([name, value]) => h("tr", {}, h("th", { scope: "row" }, name), h("td", {}, value)))));
}

function coverage(fractions: Record<string, number>): HTMLElement {
  const rows = Object.entries(fractions).map(([roi, fraction]) =>
    h(
      "tr",
      { class: fraction >= COVERED ? "" : "short" },
      h("th", { scope: "row" }, roi),
      h("td", {}, h("meter", { min: 0, max: 1, value: fraction, "aria-label": `Coverage of ${roi}` })),
      h("td", {}, percent(Math.floor(fraction * 1e4) / 1e4, 2)),
    ),
  );
  return h("table", { class: "coverage" }, h("tbody", {}, ...rows));
}

function result({ record, plan }: OpenPlan, view: PlanView): HTMLElement {
  const m = plan.metrics;
  const planning = Object.entries(m.planning_time_s ?? {});
  return h(
    "div",
    { id: "result" },
    h("h2", {}, plan.name ?? record.name ?? record.id),
    violations(plan.violations ?? [], view),
    table(
      [
        ["Length", metres(m.length_m)],
        ["Collecting", metres(m.collection_length_m)],
        ["Duty cycle", percent(m.duty_cycle)],
        ["Path length ratio", number(m.path_length_ratio, 3)],
        ...(typeof m.gap === "number" ? [["At most from the best", percent(m.gap)] as [string, string]] : []),
        ["Flight time", seconds(m.duration_s)],
        ["Turns", number(m.turns, 0)],
        ["Risk, missile", number(m.risk_missile, 2)],
        ["Risk, radar", number(m.risk_radar, 2)],
        ...(m.energy_wh === null || m.energy_wh === undefined ? [] : [["Energy", number(m.energy_wh, 0, "Wh")] as [string, string]]),
      ],
      "metrics",
    ),
    operatingStrip(plan),
    section("Coverage", true, coverage(m.coverage ?? {})),
    planning.length > 0 ? section("Planning time", false, table(planning.map(([stage, s]) => [stage, seconds(s)]))) : null,
    plan.methods ? section("Methods", false, table(Object.entries(plan.methods))) : null,
    h(
      "div",
      { class: "row files" },
      ...FILES.map(([file, label]) => h("a", { href: planUrl(record.id, file), download: `${plan.name ?? record.id}.${file.split(".")[1]}` }, label)),
      h("a", { href: planUrl(record.id, "report.html"), target: "_blank", rel: "noopener" }, "Report"),
    ),
  );
}

function line(record: PlanRecord): HTMLElement {
  const time = record.created_at ? new Date(record.created_at).toLocaleString() : "";
  const length = record.metrics ? ` · ${metres(record.metrics.length_m)}` : "";
  const show = async (): Promise<void> => {
    const edits = scenarios.edited.value && scenarios.document.value.features.length > 0;
    const lines = ["The scenario on the page is replaced; Undo brings it back."];
    if (edits && (await ask({ title: "Show this plan with its own scenario?", lines, go: "Show" })) === null) return;
    await attempt("The plan was not opened", () => openPlan(record.id));
  };
  const label = `${record.name ?? record.id} · ${record.state}${length}`;
  return h("li", {}, button(label, () => void show(), { class: "link", "aria-current": open.value?.record.id === record.id }), h("span", { class: "quiet" }, ` ${time}`));
}

function earlier(): HTMLElement {
  const items = h("ul", { class: "plain", id: "recent" });
  const draw = (): void =>
    fill(items, ...recent.value.slice(0, RECENT_SHOWN).map(line), recent.value.length === 0 ? h("li", { class: "quiet" }, "None yet.") : null);
  recent.watch(draw);
  open.watch(draw);
  return section("Recent plans", true, items, button("Refresh", () => void attempt("The plans were not listed", refresh)));
}

export function planPanel(view: PlanView): HTMLElement {
  const go = button("Plan this scenario", () => void attempt("Planning was not started", startPlan), { class: "primary", id: "plan-start" });
  const update = (): void => {
    const busy = running.value !== null && MOVING.has(running.value.state);
    go.disabled = busy || judgement.value.state === "empty" || judgement.value.state === "refused";
    go.title = judgement.value.state === "refused" ? "The scenario is refused; see the findings under Scenario" : "";
  };
  running.watch(update);
  judgement.watch(update);
  const box = h("div", {});
  const beside = section("Compare", false, comparison());
  const stale = h("p", { class: "warning", hidden: true }, "The scenario was changed after this plan was made.");
  const compare = (): void => {
    stale.hidden = !open.value || open.value.madeFrom === scenarios.text();
  };
  open.watch((plan) => {
    compare();
    fill(box, plan ? result(plan, view) : null);
    beside.hidden = plan === null;
  });
  scenarios.document.watch(compare);
  return h("div", {}, h("div", { class: "row" }, go), progress(view), stale, box, beside, earlier());
}
