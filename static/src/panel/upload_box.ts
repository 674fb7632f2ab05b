/** Sending the plan on the map to the vehicle, and what the vehicle answered. */
import { ApiError } from "../api";
import { ask } from "../dialog";
import { button, fill, h } from "../dom";
import { encoding } from "../encoding";
import { preflight, readVehicle, upload, watched, type Override } from "../fleet";
import { freshness } from "../freshness";
import { hearing } from "../hearing";
import { inFlight, planName } from "../holding";
import { keepNow } from "../keeping";
import { attempt, findingText, report } from "../notices";
import { pathsOf } from "../phases";
import { open } from "../plans";
import { scenarios } from "../scenario";
import type { Part, Upload, Vehicle } from "../types";
import { endBox } from "./end_box";
import { encodingFields } from "./encoding_fields";
import { goesOn } from "./goes_on";
import { readiness } from "./readiness";
import { uploadAnswer } from "./upload_answer";

/** Refusals that an operator may overrule, with a reason. */
const OVERRULED = [":unsafe"];

/** What the vehicle is left with when nothing was sent to it. */
function leftWith({ name, sent }: Vehicle): string {
  if (!sent) return `Nothing was sent to ${name}; what it holds was not sent from here.`;
  return sent.standing === "held" ? `Nothing was sent to ${name}; it still holds ${planName(sent.plan_id)}.` : `Nothing was sent to ${name}; ${planName(sent.plan_id)} was sent to it before.`;
}

/** The controls, and what is answered to them: apart, as long answers must not move controls. */
/** What a vehicle is at, with the plan's name in place of its id. */
const named = (operation: string): string => operation.replace(/plan ([0-9a-f-]{36})/, (_, id: string) => planName(id));

export function uploadBox(edit: () => void): { controls: HTMLElement; answers: HTMLElement } {
  const part = (name: Part, title: string, checked = true): HTMLInputElement => h("input", { type: "checkbox", id: `part-${name}`, checked, title, onchange: () => update() });
  const parts: Record<Part, HTMLInputElement> = {
    mission: part("mission", "The flight, with the sensor switched at both ends of every pass"),
    fence: part("fence", "Operating area, no-fly zones, obstacles and hard threats, as the vehicle's own fence"),
    rally: part("rally", "Plans have none: this clears the vehicle's rally points, so that a return leads home", false),
  };
  const flown = h("select", { id: "plan-vehicle" });
  const flownField = h("div", { class: "field", hidden: true }, h("label", { for: "plan-vehicle" }, "Which of the plan's aircraft it is"), flown);
  const result = h("div", { id: "upload-result", "aria-live": "polite" });
  const moving = h("div", {});
  const go = button("Upload the plan", () => void send(null), { class: "primary", id: "upload" });
  const why = h("p", { id: "upload-why" });
  const check = button("Check before flight", () => void inquire(), { id: "preflight", title: "Reads the vehicle and changes nothing in it" });
  const checked = h("div", { id: "preflight-result", "aria-live": "polite" });
  const subject = (): string => `${watched.value?.id ?? ""}/${open.value?.record.id ?? ""}/${freshness.value.state}`;
  const ofPlan = (): string | null => (flownField.hidden ? null : flown.value);
  const inquire = async (): Promise<void> => {
    const vehicle = watched.value;
    const plan = open.value;
    if (!vehicle || !plan) return;
    const about = subject();
    fill(checked, h("p", {}, `Asking ${vehicle.name} …`));
    const found = await attempt(`${vehicle.name} was not checked`, () => preflight(vehicle.id, plan.record.id, ofPlan(), encoding.value));
    // The answer is of this vehicle and this plan alone.
    if (subject() === about) fill(checked, found ? readiness(found) : null);
  };

  const tell = (answer: Upload, id: string): void => fill(result, uploadAnswer(answer, open.value?.record.id), goesOn([{ id, upload: answer }]));
  const send = async (override: Override | null): Promise<void> => {
    const vehicle = watched.value;
    const plan = open.value;
    if (!vehicle || !plan || freshness.value.state === "stale") return;
    const chosen = (Object.keys(parts) as Part[]).filter((name) => parts[name].checked && !parts[name].disabled);
    go.disabled = true;
    fill(result, h("p", {}, `Uploading to ${vehicle.name} …`));
    try {
      // The service compares the plan with the scenario it keeps: an edit just undone has to be there.
      await keepNow();
      const answer = await upload(vehicle.id, plan.record.id, ofPlan(), chosen, encoding.value, override);
      if (watched.value?.id === vehicle.id) tell(answer, vehicle.id);
    } catch (error) {
      const overruled = error instanceof ApiError && !override && OVERRULED.some((ending) => error.problem.type?.endsWith(ending));
      if (overruled) await offerOverride(error as ApiError, vehicle);
      else await notSent(error, vehicle);
    } finally {
      update();
    }
  };

  /** A refusal before anything was sent; a broken connection may have come in the middle of it. */
  const notSent = async (error: unknown, vehicle: Vehicle): Promise<void> => {
    if (error instanceof ApiError && error.status < 500) {
      report(`Nothing was uploaded to ${vehicle.name}`, error);
      fill(result, h("p", { class: "warning" }, leftWith(vehicle)));
      return;
    }
    report(`Whether ${vehicle.name} took the upload is not known`, error);
    fill(result, h("p", { class: "warning" }, `Whether ${vehicle.name} took it is not known: Check before flight reads it back.`));
  };

  const offerOverride = async (error: ApiError, vehicle: Vehicle): Promise<void> => {
    const reasons = error.errors.map(findingText);
    const reason = await ask({
      title: "This plan is not to be flown without an explicit override",
      lines: [error.problem.detail ?? error.problem.title, ...reasons],
      go: "Upload all the same",
      reason: "Why it is uploaded all the same (kept with the upload)",
    });
    if (reason !== null) return send({ reason });
    const now = await attempt(`${vehicle.name} could not be read`, () => readVehicle(vehicle.id));
    fill(result, h("p", { class: "warning" }, `Cancelled. ${leftWith(now ?? vehicle)}`));
  };

  /** Why the plan cannot go up; empty when it can. */
  const shut = (): string => {
    const vehicle = watched.value;
    if (!vehicle) return "No vehicle is chosen.";
    if (vehicle.replay) return "A recording takes no uploads.";
    if (!vehicle.connected) return hearing(vehicle).lost ? "Its link is lost." : "The vehicle is not heard.";
    if (!open.value) return "No plan is on the map: make one under Plan.";
    return vehicle.operation ? `At work: ${named(vehicle.operation)}` : "";
  };

  /** A plan from the air takes the place of the mission alone: a fence is not replaced under an aircraft. */
  const aloft = (): boolean => {
    const vehicle = watched.value;
    return vehicle !== null && inFlight(vehicle) && (scenarios.document.value.vehicles ?? []).some((member) => member["in_flight"] !== undefined);
  };

  let shownNumber: string | null = null;
  let shownSubject = subject();
  const update = (): void => {
    const vehicle: Vehicle | null = watched.value;
    const busy = vehicle?.operation ?? null;
    const reason = shut();
    const { state, reason: stale } = freshness.value;
    check.disabled = reason !== "";
    parts.fence.disabled = parts.rally.disabled = aloft();
    go.disabled = reason !== "" || state === "stale" || !Object.values(parts).some((box) => box.checked && !box.disabled);
    const words = reason || (state === "stale" ? `This plan cannot go up: it is out of date. ${stale}` : "");
    why.className = state === "stale" ? "error" : "quiet";
    if (why.textContent !== words) why.textContent = words;
    go.title = words || "Uploads, reads back and compares; nothing moves by it";
    fill(moving, vehicle?.transfer ? h("progress", { max: Math.max(1, vehicle.transfer.total), value: vehicle.transfer.done, "aria-label": "Upload progress" }) : null);
    const turned = subject() !== shownSubject;
    shownSubject = subject();
    if (turned) fill(checked);
    const number = vehicle?.upload ? `${vehicle.id}/${vehicle.upload.number}/${vehicle.upload.outcome}/${vehicle.upload.verified}` : null;
    if ((turned || number !== shownNumber) && busy === null) {
      shownNumber = number;
      if (vehicle?.upload) tell(vehicle.upload, vehicle.id);
      else fill(result);
    }
  };
  open.watch((shown) => {
    const names = [...new Set((shown ? pathsOf(shown.plan) : []).map(({ properties }) => String(properties?.["vehicle"] ?? "")))];
    flownField.hidden = names.length < 2;
    const before = flown.value;
    fill(flown, ...names.map((name) => h("option", { value: name }, name)));
    if (names.includes(before)) flown.value = before;
  });
  watched.watch(update);
  open.watch(update);
  freshness.watch(update);
  const tick = (name: Part, label: string): HTMLElement => h("span", { class: "field tick" }, parts[name], h("label", { for: `part-${name}` }, label));
  return {
    controls: h("div", { role: "group", "aria-label": "Upload and check" }, h("div", { class: "row" }, go, check), why, h("div", { class: "row" }, tick("mission", "mission"), tick("fence", "fence"), tick("rally", "rally")), flownField, endBox(edit), encodingFields()),
    answers: h("div", {}, moving, result, checked),
  };
}
