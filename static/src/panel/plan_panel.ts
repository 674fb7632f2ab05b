/** The planning side of the panel: start, progress, results, violations, files, earlier plans. */
import { ask } from "../dialog";
import { button, fill, h, section } from "../dom";
import { attempt, findingText } from "../notices";
import { scenarios } from "../scenario";
import { cancelPlan, coming, deletePlan, isSearch, open, openPlan, planUrl, problemOf, recent, refresh, running, startPlan, type OpenPlan } from "../plans";
import { freshness } from "../freshness";
import { mayLeave } from "../leaving";
import { readFindings, readiness } from "../api";
import type { Metrics, PlanRecord, Position, Problem, Violation } from "../types";
import { metres, number, percent, percentDown, seconds } from "../units";
import { judgement } from "../validation";
import { crewBox } from "./crew_box";
import { comparison } from "./compare";
import { moreOf } from "./more";
import { pathsOf } from "../phases";
import { phaseTable } from "./phase_table";
import { profileBox } from "./profile_box";
import { replanBox } from "./replan_box";
import { operatingStrip } from "./strip";
import { leftOut, vehiclesTable } from "./vehicles_table";
import { surveyBox } from "./survey_box";
import { waypointList } from "./waypoint_list";

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
const START = "Plan this scenario";
const SECOND_MS = 1000;
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

const waitsFor = (): string => (readiness.value === "starting" ? "waiting until the service is ready to plan" : "waiting for a free worker");

/** Bar, stage and cancel button; they stay the same elements, so that a click or the focus is never lost. */
function progress(view: PlanView): HTMLElement {
  const bar = h("progress", { max: 1, "aria-label": "Planning progress" });
  const words = h("p", { role: "status" });
  const cancel = button("Cancel planning", () => void attempt("The plan was not cancelled", cancelPlan), { class: "danger", id: "plan-cancel" });
  const reasons = h("div", {});
  const box = h("div", { id: "progress" }, bar, words, reasons, cancel);
  const say = (record: PlanRecord, fraction: number, moving: boolean): void => {
    const since = record.started_at ?? record.created_at;
    const passed = since ? seconds(Math.max(0, Math.round((Date.now() - Date.parse(since)) / 1000))) : "";
    const at = record.state === "queued" ? waitsFor() : (record.stage ?? "starting");
    const over = record.state === "done" ? "Planned; its figures are being read …" : `Plan ${record.state}`;
    const text = moving ? [at, percent(fraction, 0), passed].filter(Boolean).join(" · ") : over;
    if (words.textContent !== text) words.textContent = text;
  };
  setInterval(() => {
    const record = running.value;
    if (record && MOVING.has(record.state)) say(record, record.progress ?? 0, true);
  }, SECOND_MS);
  running.watch((record) => {
    box.hidden = record === null;
    if (!record) return;
    const fraction = Math.min(1, Math.max(0, record.progress ?? 0));
    const problem = problemOf(record);
    const moving = MOVING.has(record.state);
    bar.hidden = !moving;
    cancel.hidden = !moving;
    bar.value = fraction;
    say(record, fraction, moving);
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

function coverage(fractions: Record<string, number>, searched: boolean): HTMLElement {
  const rows = Object.entries(fractions).map(([roi, fraction]) =>
    h(
      "tr",
      { class: searched || fraction >= COVERED ? "" : "short" },
      h("th", { scope: "row" }, roi),
      h("td", {}, h("meter", { min: 0, max: 1, value: fraction, "aria-label": `Coverage of ${roi}` })),
      h("td", {}, percentDown(fraction)),
    ),
  );
  return h("table", { class: "coverage" }, h("tbody", {}, ...rows));
}

/** Whether risks mean anything: a plan among no threats has none. */
const threatened = (m: Metrics): boolean =>
  m.risk_missile > 0 || m.risk_radar > 0 || scenarios.document.value.features.some(({ properties }) => properties.role === "threat");

function result({ record, plan, items, madeFrom }: OpenPlan, view: PlanView): HTMLElement {
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
        ...(m.area_seen_m2 == null ? [] : [["Ground seen", number(m.area_seen_m2 / 1e6, 3, "km²")] as [string, string]]),
        ...(m.area_seen_bound_m2 == null ? [] : [["No flight sees more than", number(m.area_seen_bound_m2 / 1e6, 3, "km²")] as [string, string]]),
        ...(m.importance_collected == null ? [] : [["Importance collected", m.importance_total ? `${percent(m.importance_collected / m.importance_total)} of ${number(m.importance_total, 0)}` : number(m.importance_collected, 0)] as [string, string]]),
        ...(m.importance_bound == null ? [] : [["No flight collects more than", m.importance_total ? percent(m.importance_bound / m.importance_total) : number(m.importance_bound, 0)] as [string, string]]),
        ["Collecting", metres(m.collection_length_m)],
        ["Duty cycle", percent(m.duty_cycle)],
        ...(m.path_length_ratio === null ? [] : [["Path length ratio", number(m.path_length_ratio, 3)] as [string, string]]),
        ...(typeof m.gap === "number" && (m.lower_bound_m ?? 0) > 0 ? [["At most from the best", percent(m.gap)] as [string, string]] : []),
        ...(m.flight_length_m == null ? [] : [["Whole flight", metres(m.flight_length_m)] as [string, string]]),
        ...(m.flight_duration_s == null ? [] : [[pathsOf(plan).length > 1 ? "Flight time, all flights together" : "Flight time, take-off to landing", seconds(m.flight_duration_s)] as [string, string]]),
        [m.flight_duration_s == null ? "Time of the mission alone" : "Of it the mission", seconds(m.duration_s)],
        ["Turns", number(m.turns, 0)],
        ...(threatened(m) ? ([["Risk, missile", number(m.risk_missile, 2)], ["Risk, radar", number(m.risk_radar, 2)]] as [string, string][]) : []),
        ...(m.energy_wh === null || m.energy_wh === undefined ? [] : [["Energy", number(m.energy_wh, 0, "Wh")] as [string, string]]),
      ],
      "metrics",
    ),
    vehiclesTable({ record, plan, items, madeFrom }),
    leftOut({ record, plan, items, madeFrom }),
    pathsOf(plan).length > 1 ? section("Parts of each flight", false, phaseTable(plan)) : phaseTable(plan),
    pathsOf(plan).length > 1 ? null : operatingStrip(plan),
    section("Coverage", true, coverage(m.coverage ?? {}, isSearch(plan))),
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

function line(record: PlanRecord, view: PlanView): HTMLElement {
  const time = record.created_at ? new Date(record.created_at).toLocaleString() : "";
  const length = record.metrics ? ` · ${metres(record.metrics.length_m)}` : "";
  const show = async (): Promise<void> => {
    if (!(await mayLeave("Show this plan with its own scenario?", "Show"))) return;
    if (await attempt("The plan was not opened", () => openPlan(record.id))) view.zoomToAll();
  };
  const label = `${record.name ?? record.id} · ${record.state}${length}`;
  const gone = async (): Promise<void> => {
    const lines = ["The plan and its files are deleted; a mission in a vehicle stays as it is. Flights of it keep their tracks, but what they saw can no longer be judged."];
    if ((await ask({ title: `Delete ${record.name ?? "this plan"}?`, lines, go: "Delete" })) !== null) await attempt("The plan was not deleted", () => deletePlan(record.id));
  };
  return h(
    "li",
    {},
    button(label, () => void show(), { class: "link", "aria-current": open.value?.record.id === record.id }),
    h("span", { class: "quiet" }, ` ${time} `),
    MOVING.has(record.state) ? null : button("Delete", () => void gone(), { class: "link quiet", "aria-label": `Delete plan ${record.name ?? record.id}, ${time}` }),
  );
}

function earlier(view: PlanView): HTMLElement {
  return section("Recent plans", true, moreOf("recent", recent, (record) => line(record, view), [open]), button("Refresh", () => void attempt("The plans were not listed", refresh)));
}

export function planPanel(view: PlanView): HTMLElement {
  // From the click to the service's answer, which judges the scenario first: a second click would plan twice.
  let asking = false;
  const start = async (): Promise<void> => {
    asking = true;
    update();
    await attempt("Planning was not started", startPlan);
    asking = false;
    update();
  };
  const go = button(START, () => void start(), { class: "primary", id: "plan-start" });
  const update = (): void => {
    fill(go, asking ? "Asking the service …" : START);
    const busy = asking || running.value !== null && MOVING.has(running.value.state);
    go.disabled = busy || judgement.value.state === "empty" || judgement.value.state === "refused";
    go.title = judgement.value.state === "refused" ? "The scenario is refused; see the findings under Scenario" : "";
  };
  running.watch(update);
  judgement.watch(update);
  const box = h("div", {});
  const reading = h("p", { class: "quiet", role: "status", hidden: true }, "The plan is being read …");
  const read = (): void => {
    reading.hidden = coming.value === null || running.value !== null;
  };
  coming.watch(read);
  running.watch(read);
  const beside = section("Compare", false, comparison());
  const stale = h("p", { class: "error banner", id: "stale", hidden: true });
  freshness.watch(({ state, reason }) => {
    stale.hidden = state !== "stale";
    fill(stale, h("strong", {}, "OUT OF DATE. "), reason);
    box.classList.toggle("stale", state === "stale");
  });
  open.watch((plan) => {
    fill(box, plan ? result(plan, view) : null);
    beside.hidden = plan === null;
  });
  return h("div", {}, h("div", { class: "row" }, go), progress(view), reading, stale, crewBox(), replanBox(), box, surveyBox(), profileBox(), waypointList(view.zoomToPlace), beside, earlier(view));
}
