/** In words: what of scenario, plan and mission each vehicle stands at. One place for all that is told of it. */
import { freshness } from "./freshness";
import { hearing } from "./hearing";
import { keeping } from "./keeping";
import { coming, open, recent, running } from "./plans";
import { scenarios } from "./scenario";
import type { Vehicle } from "./types";

export type Tone = "good" | "warning" | "error" | "quiet" | "";

export interface Step {
  label: "Edited" | "Planned" | "Uploaded" | "Flying";
  words: string;
  tone: Tone;
  more: string;
}

const MOVING = new Set(["queued", "running"]);

/** The plan on the map, or on its way there where there is none. */
const shownId = (): string | null => open.value?.record.id ?? coming.value;

export function planName(id: string): string {
  if (shownId() === id) return "the plan on the map";
  const known = recent.value.find((record) => record.id === id);
  return known?.name ? `plan “${known.name}” (${id.slice(0, 8)})` : `plan ${id.slice(0, 8)}`;
}

const KEPT = {
  shown: "as the service has it",
  waiting: "being kept …",
  kept: "kept by the service",
  tab: "in this tab alone",
  changed: "CHANGED IN ANOTHER TAB",
  failed: "NOT KEPT: the service did not take it",
} as const;

function edited(): Step {
  const { value: document } = scenarios.document;
  const { state } = keeping.value;
  const name = document.name ?? "untitled";
  if (document.features.length === 0) return { label: "Edited", words: "empty scenario", tone: "quiet", more: "Draw or open a scenario" };
  const tone: Tone = state === "changed" || state === "failed" ? "error" : "";
  return { label: "Edited", words: state === "changed" || state === "failed" ? KEPT[state] : name, tone, more: `${name}: ${KEPT[state]}` };
}

function planned(): Step {
  const making = running.value;
  if (making && MOVING.has(making.state)) return { label: "Planned", words: `planning … ${Math.round((making.progress ?? 0) * 100)} %`, tone: "warning", more: making.stage ?? making.state };
  if (making && (making.state === "failed" || making.state === "cancelled")) return { label: "Planned", words: `${making.state}: no plan`, tone: "error", more: "See under Plan" };
  if (!open.value && coming.value !== null) return { label: "Planned", words: "being read …", tone: "quiet", more: "The plan is on its way onto the map" };
  if (!open.value) return { label: "Planned", words: "no plan", tone: "quiet", more: "Plan the scenario under Plan" };
  const { state, reason } = freshness.value;
  const hard = (open.value.plan.violations ?? []).filter((violation) => violation.hard).length;
  if (state === "stale") return { label: "Planned", words: "OUT OF DATE", tone: "error", more: reason };
  if (hard > 0) return { label: "Planned", words: `${hard} violation${hard > 1 ? "s" : ""}`, tone: "error", more: "The plan breaks hard constraints: see under Plan" };
  return { label: "Planned", words: "up to date", tone: "good", more: open.value.plan.name ?? open.value.record.id };
}

function uploaded(vehicle: Vehicle): Step {
  const step = (words: string, tone: Tone, more: string): Step => ({ label: "Uploaded", words, tone, more });
  if (vehicle.replay) return step("–", "quiet", "A recording takes no mission");
  if (vehicle.transfer) return step(`${vehicle.transfer.part} ${vehicle.transfer.done} of ${vehicle.transfer.total}`, "warning", "A transfer is at work");
  if (vehicle.pending) return step("not known", "warning", "The last upload's outcome is unknown; it is read back when the vehicle is heard");
  const { sent } = vehicle;
  if (!sent) return step(vehicle.state.mission_total ? "not from here" : "nothing", "quiet", "Nothing was sent to it from here, or it was cleared");
  const here = shownId() === sent.plan_id;
  const name = planName(sent.plan_id);
  if (sent.standing === "differs") return step("NOT what was sent", "error", `It does not hold ${name}, which was sent to it`);
  if (sent.standing === "unknown") return step("not known", "warning", `${name} was sent; whether it is still held is not known`);
  if (!here) return step("ANOTHER PLAN", open.value ? "error" : "warning", `It holds ${name}, not the plan on the map`);
  if (freshness.value.state === "stale") return step("this plan, OUT OF DATE", "error", `It holds the plan on the map. ${freshness.value.reason}`);
  return step(sent.shown_by === "read_back" ? "this plan" : "this plan, by its id", sent.shown_by === "read_back" ? "good" : "warning", sent.shown_by === "read_back" ? "Read back equal" : "Check before flight compares it");
}

/** Whether it is off the ground, as far as it is told. */
export function inFlight({ flight_id, state }: Vehicle): boolean {
  return flight_id !== null || (state.armed && state.landed === false);
}

function flying(vehicle: Vehicle): Step {
  const step = flyingAsTold(vehicle);
  if (!hearing(vehicle).lost) return step;
  return { ...step, words: `was ${step.words}`, tone: "error", more: `When it was last heard: ${step.more}` };
}

function flyingAsTold(vehicle: Vehicle): Step {
  const { state } = vehicle;
  const item = state.mission_current === null ? "" : `item ${state.mission_current}${state.mission_total ? ` of ${state.mission_total - 1}` : ""}`;
  const step = (words: string, tone: Tone, more: string): Step => ({ label: "Flying", words, tone, more });
  if (vehicle.system_id === null) return step("–", "quiet", "It was not heard yet");
  if (!inFlight(vehicle)) return state.armed ? step("ARMED on the ground", "warning", "Its motors may start") : step("on the ground", "quiet", "Disarmed");
  const held = vehicle.sent?.standing === "held" ? vehicle.sent.plan_id : vehicle.plan_id;
  const same = held !== null && held === shownId();
  const words = state.mission_state === "active" && item ? item : state.mode.toLowerCase() || "in flight";
  const what = held === null ? "a mission that was not sent from here" : planName(held);
  return step(same ? words : `${words}, ANOTHER PLAN`, same ? (freshness.value.state === "stale" ? "warning" : "good") : "warning", `In flight with ${what}${item ? `, ${item}` : ""}`);
}

/** The four steps from an idea to a flight, for one vehicle. */
export function stepsOf(vehicle: Vehicle | null): Step[] {
  return vehicle ? [edited(), planned(), uploaded(vehicle), flying(vehicle)] : [edited(), planned()];
}
