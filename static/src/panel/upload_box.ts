/** Sending the plan on the map to the vehicle, and what the vehicle answered. */
import { ApiError } from "../api";
import { ask } from "../dialog";
import { button, fill, h, section } from "../dom";
import { preflight, upload, watched, type Encoding, type Override } from "../fleet";
import { attempt, findingText, report } from "../notices";
import { open } from "../plans";
import type { Part, Preflight, Upload, Vehicle } from "../types";
import { number } from "../units";

const DIFFERENCES_SHOWN = 8;
const WORDS: Record<Upload["outcome"], string> = {
  accepted: "The vehicle accepted it",
  different: "The vehicle never answered, and holds something else than was meant",
  refused: "The vehicle refused it",
  unknown: "Outcome unknown: the vehicle did not answer to the end. It is read back as soon as it is heard again",
  not_attempted: "Not attempted",
};

function partLine(name: string, part: Upload["parts"][string]): HTMLElement {
  const differing = part.differences?.length ?? 0;
  const compared = part.verified
    ? "read back equal"
    : part.differences === null
      ? "not read back"
      : `${differing} differences`;
  const lines = (part.differences ?? []).slice(0, DIFFERENCES_SHOWN).map((difference) => h("li", {}, difference.message));
  return h(
    "li",
    { class: part.verified ? "" : part.outcome === "accepted" || part.outcome === "unknown" ? "warning" : "error" },
    `${name}: ${part.meant} items, ${part.outcome.replace("_", " ")}, ${compared}${part.reason && part.reason !== part.outcome ? ` – ${part.reason}` : ""}`,
    lines.length > 0 ? h("ul", {}, ...lines, differing > lines.length ? h("li", {}, `and ${differing - lines.length} more`) : null) : null,
  );
}

/** The check before flight: its verdict open to see, what is in order folded away. */
function readiness(found: Preflight): HTMLElement {
  const line = ({ name, status, detail }: Preflight["checks"][number]): HTMLElement =>
    h("li", { class: status === "failed" ? "error" : status === "warning" ? "warning" : "sound" }, h("strong", {}, name.replaceAll("_", " ")), `: ${detail}`);
  const open = found.checks.filter(({ status }) => status !== "ok");
  const sound = found.checks.filter(({ status }) => status === "ok");
  return h(
    "div",
    { class: "card", "data-ready": String(found.ready) },
    h("p", { class: found.ready ? "good" : "error" }, found.ready ? (open.length > 0 ? "Ready to fly; for the pilot to weigh:" : "Ready to fly: every check is in order.") : "Not ready to fly:"),
    open.length > 0 ? h("ul", { class: "findings" }, ...open.map(line)) : null,
    found.parameters.length > 0
      ? h(
          "ul",
          { class: "findings" },
          ...found.parameters.map((p) =>
            h("li", { class: p.severity }, h("strong", {}, p.name), ` is ${number(p.value, 2)}${p.advised === null ? "" : `, ${number(p.advised, 2)} would do`}: ${p.reason}`),
          ),
        )
      : null,
    sound.length > 0 ? section(`${sound.length} checks in order`, false, h("ul", { class: "findings" }, ...sound.map(line))) : null,
  );
}

/** What a vehicle answered; `plan` is the one on the map, which may be another than was sent. */
function answer(result: Upload, plan: string | undefined): HTMLElement {
  return h(
    "div",
    { "data-outcome": result.outcome, "data-verified": String(result.verified) },
    plan !== undefined && plan !== result.plan_id ? h("p", { class: "warning" }, "Another plan than the one on the map was sent:") : null,
    h("p", { class: result.outcome === "accepted" && result.verified ? "good" : "warning" }, `${WORDS[result.outcome]}${result.verified ? "; read back equal" : ""}.`),
    h("ul", { class: "findings" }, ...Object.entries(result.parts).map(([name, part]) => partLine(name, part))),
    result.findings.length > 0 ? h("ul", { class: "findings" }, ...result.findings.map((finding) => h("li", { class: finding.severity ?? "warning" }, findingText(finding)))) : null,
    ...result.notes.map((note) => h("p", { class: "quiet" }, note)),
    result.preflight ? readiness(result.preflight) : null,
    result.override_reason ? h("p", { class: "warning" }, `Sent against the check's verdict: ${result.override_reason}`) : null,
  );
}

/** Ways to switch the sensor, to be filled in; the first is what an empty field means. */
const SWITCHES = ["relay:0", "servo:9:1900:1100", "camera:distance=25", "image:interval=2", "actuator:1", "aux:1"];
const SWITCHED = "What the autopilot switches at both ends of every pass. relay:number · servo:output:on:off in µs · camera:distance=metres between photos · image:interval=seconds · PX4: actuator:number, aux:output or main:output · command:number:parameters";

/** Gimbals, to be filled in; an empty field means none. */
const GIMBALS = ["none", "manager:tilt=45", "manager:tilt=45,yaw=course", "mount:tilt=45"];
const POINTED = "A gimbal that points the sensor to the side each pass looks to. tilt=degrees from straight down · yaw=vehicle turns with the nose, yaw=course is held abeam · device=number · mount for older firmware";

/** The controls, and what is answered to them: apart, as long answers must not move controls. */
export function uploadBox(): { controls: HTMLElement; answers: HTMLElement } {
  const part = (name: Part, title: string, checked = true): HTMLInputElement => h("input", { type: "checkbox", id: `part-${name}`, checked, title, onchange: () => update() });
  const parts: Record<Part, HTMLInputElement> = { 
    mission: part("mission", "The flight, with the sensor switched at both ends of every pass"),
    fence: part("fence", "Operating area, no-fly zones, obstacles and hard threats, as the vehicle's own fence"),
    rally: part("rally", "Plans have none: this clears the vehicle's rally points, so that a return leads home", false),
  };
  const payload = h("input", { id: "payload", type: "text", list: "payloads", placeholder: SWITCHES[0], maxlength: 200, autocomplete: "off", spellcheck: "false", "aria-describedby": "payload-hint" });
  const gimbal = h("input", { id: "gimbal", type: "text", list: "gimbals", placeholder: GIMBALS[0], maxlength: 200, autocomplete: "off", spellcheck: "false", "aria-describedby": "gimbal-hint" });
  const switching = section(
    "Payload: how it is switched and pointed",
    false,
    h("div", { class: "field" }, h("label", { for: "payload" }, `Output or command (${SWITCHES[0]} when empty)`), payload),
    h("datalist", { id: "payloads" }, ...SWITCHES.map((value) => h("option", { value }))),
    h("p", { class: "quiet", id: "payload-hint" }, SWITCHED),
    h("div", { class: "field" }, h("label", { for: "gimbal" }, "Gimbal (bolted on when empty)"), gimbal),
    h("datalist", { id: "gimbals" }, ...GIMBALS.map((value) => h("option", { value }))),
    h("p", { class: "quiet", id: "gimbal-hint" }, POINTED),
  );
  const asked = (): Encoding => ({ payload: payload.value.trim() || null, gimbal: gimbal.value.trim() || null });
  const result = h("div", { id: "upload-result", "aria-live": "polite" });
  const moving = h("div", {});
  const go = button("Upload the plan", () => void send(null), { class: "primary", id: "upload" });
  const why = h("p", { class: "quiet" });
  const check = button("Check before flight", () => void inquire(), { id: "preflight", title: "Reads the vehicle and changes nothing in it" });
  const checked = h("div", { id: "preflight-result", "aria-live": "polite" });
  const subject = (): string => `${watched.value?.id ?? ""}/${open.value?.record.id ?? ""}`;
  const inquire = async (): Promise<void> => {
    const vehicle = watched.value;
    const plan = open.value;
    if (!vehicle || !plan) return;
    const about = subject();
    fill(checked, h("p", {}, `Asking ${vehicle.name} …`));
    const found = await attempt(`${vehicle.name} was not checked`, () => preflight(vehicle.id, plan.record.id, asked()));
    // The answer is of this vehicle and this plan alone.
    if (subject() === about) fill(checked, found ? readiness(found) : null);
  };

  const send = async (override: Override | null): Promise<void> => {
    const vehicle = watched.value;
    const plan = open.value;
    if (!vehicle || !plan) return;
    const chosen = (Object.keys(parts) as Part[]).filter((name) => parts[name].checked);
    go.disabled = true;
    fill(result, h("p", {}, `Uploading to ${vehicle.name} …`));
    try {
      fill(result, answer(await upload(vehicle.id, plan.record.id, chosen, asked(), override), open.value?.record.id));
    } catch (error) {
      fill(result);
      if (error instanceof ApiError && error.problem.type?.endsWith(":unsafe") && !override) await offerOverride(error);
      else report(`Nothing was uploaded to ${vehicle.name}`, error);
    } finally {
      update();
    }
  };

  const offerOverride = async (error: ApiError): Promise<void> => {
    const reasons = error.errors.map(findingText);
    const reason = await ask({
      title: "This plan is not to be flown without an explicit override",
      lines: [error.problem.detail ?? error.problem.title, ...reasons],
      go: "Upload all the same",
      reason: "Why it is uploaded all the same (kept with the upload)",
    });
    if (reason !== null) await send({ reason });
    else fill(result, h("p", { class: "warning" }, "Not uploaded: the plan breaks a hard constraint."));
  };

  let shownNumber: string | null = null;
  let shownSubject = subject();
  const update = (): void => {
    const vehicle: Vehicle | null = watched.value;
    const busy = vehicle?.operation ?? null;
    check.disabled = !vehicle?.connected || vehicle.replay || !open.value || busy !== null;
    go.disabled = check.disabled || !Object.values(parts).some((box) => box.checked);
    fill(why, !vehicle ? "No vehicle is chosen." : !vehicle.connected ? "The vehicle is not heard." : vehicle.replay ? "A recording takes no uploads." : !open.value ? "No plan is on the map: make one under Plan." : busy ? `At work: ${busy}` : "");
    fill(moving, vehicle?.transfer ? h("progress", { max: Math.max(1, vehicle.transfer.total), value: vehicle.transfer.done, "aria-label": "Upload progress" }) : null);
    const turned = subject() !== shownSubject;
    shownSubject = subject();
    if (turned) fill(checked);
    const number = vehicle?.upload ? `${vehicle.id}/${vehicle.upload.number}/${vehicle.upload.outcome}/${vehicle.upload.verified}` : null;
    if ((turned || number !== shownNumber) && busy === null) {
      shownNumber = number;
      fill(result, vehicle?.upload ? answer(vehicle.upload, open.value?.record.id) : null);
    }
  };
  watched.watch(update);
  open.watch(update);
  const tick = (name: Part, label: string): HTMLElement => h("span", { class: "field tick" }, parts[name], h("label", { for: `part-${name}` }, label));
  return {
    controls: h("div", { role: "group", "aria-label": "Upload and check" }, h("div", { class: "row" }, go, check), h("div", { class: "row" }, tick("mission", "mission"), tick("fence", "fence"), tick("rally", "rally")), switching),
    answers: h("div", {}, why, moving, result, checked),
  };
}
