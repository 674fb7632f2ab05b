/** Sending every aircraft of the plan on the map its own mission in one go, with one verdict. */
import { ApiError, post } from "../api";
import { isDark } from "../crew/clock";
import { coloursOf, crewOf } from "../crew/flights";
import { ask } from "../dialog";
import { button, fill, h, section } from "../dom";
import { encoding, bodyOf } from "../encoding";
import { answered, vehicles } from "../fleet";
import { freshness } from "../freshness";
import { keepNow } from "../keeping";
import { findingText, report } from "../notices";
import { open } from "../plans";
import { goesOn } from "./goes_on";
import type { Finding, Upload, UploadOutcome } from "../types";

interface Told {
  vehicle_id: string;
  outcome: UploadOutcome;
  upload: Upload | null;
  reason: string | null;
  findings: Finding[];
}

interface FleetUpload {
  outcome: UploadOutcome;
  verified: boolean;
  vehicles: Record<string, Told>;
}

const VERDICT: Record<UploadOutcome, string> = {
  accepted: "Every aircraft accepted its mission",
  different: "An aircraft holds something else than was meant",
  refused: "Not every aircraft took its mission",
  unknown: "Of one aircraft nobody can tell: it is read back as soon as it is heard again",
  not_attempted: "Not every aircraft was sent its mission",
};

function line(name: string, told: Told): HTMLElement {
  const part = told.upload?.parts["mission"];
  const done = told.outcome === "accepted" && told.upload?.verified === true;
  const words = part ? `${part.meant} items, ${part.outcome.replace("_", " ")}${part.verified ? ", read back equal" : ""}` : (told.reason ?? told.outcome);
  return h("li", { class: done ? "" : "error" }, `${name}: ${words}`, told.findings.length > 0 ? h("ul", {}, ...told.findings.map((finding) => h("li", {}, findingText(finding)))) : null);
}

function answer(result: FleetUpload): HTMLElement {
  const sent = Object.values(result.vehicles).flatMap(({ vehicle_id, upload }) => (upload ? [{ id: vehicle_id, upload }] : []));
  return h(
    "div",
    { id: "fleet-result", "data-outcome": result.outcome, "data-verified": String(result.verified) },
    h("p", { class: result.verified ? "good" : "warning" }, `${VERDICT[result.outcome]}${result.verified ? "; all read back equal" : ""}.`),
    h("ul", { class: "findings" }, ...Object.entries(result.vehicles).map(([name, told]) => line(name, told))),
    goesOn(sent),
  );
}

export function fleetUploadBox(): HTMLElement {
  const rows = h("div", { class: "grid" });
  const result = h("div", { "aria-live": "polite" });
  const go = button("Upload to all", () => void send(null), { class: "primary", id: "upload-all" });
  const why = h("p", { class: "quiet" });
  const box = section("Upload to the whole fleet", true, rows, h("div", { class: "row" }, go), why, result);
  box.id = "fleet-upload";
  const chosen = new Map<string, HTMLSelectElement>();

  const send = async (override: string | null): Promise<void> => {
    const shown = open.value;
    if (!shown) return;
    go.disabled = true;
    fill(result, h("p", {}, "Uploading to all aircraft …"));
    try {
      await keepNow();
      const of = Object.fromEntries([...chosen].map(([name, select]) => [name, select.value]));
      const { payload, gimbal } = bodyOf(encoding.value) as { payload?: string; gimbal?: string };
      const body = { plan_id: shown.record.id, vehicles: of, parts: ["mission"], ...(payload ? { payload } : {}), ...(gimbal ? { gimbal } : {}), ...(override === null ? {} : { override: true, reason: override }) };
      fill(result, answer(await answered(post<FleetUpload>("/vehicles/missions", body))));
    } catch (error) {
      if (error instanceof ApiError && override === null && error.problem.type?.endsWith(":unsafe")) return void (await overrule(error));
      fill(result, h("p", { class: "warning" }, error instanceof ApiError && error.status < 500 ? "Nothing was sent to any of them." : "What they took is not known: Check before flight reads each back."));
      report("Not all aircraft were sent their missions", error);
    } finally {
      update();
    }
  };
  const overrule = async (error: ApiError): Promise<void> => {
    const reason = await ask({
      title: "This plan is not to be flown without an explicit override",
      lines: [error.problem.detail ?? error.problem.title, ...error.errors.map(findingText)],
      go: "Upload all the same",
      reason: "Why it is uploaded all the same (kept with the upload)",
    });
    if (reason !== null) return send(reason);
    fill(result, h("p", { class: "warning" }, "Cancelled: nothing was sent to any of them."));
  };

  const update = (): void => {
    const ids = [...chosen.values()].map(({ value }) => value);
    const words =
      freshness.value.state === "stale"
        ? "This plan is out of date."
        : ids.some((id) => id === "")
          ? "Say for each which connected vehicle it is."
          : new Set(ids).size < ids.length
            ? "Two of them are the same vehicle."
            : "";
    go.disabled = words !== "";
    if (why.textContent !== words) why.textContent = words;
  };
  let key = "";
  const draw = (): void => {
    const shown = open.value;
    const crew = shown ? crewOf(shown.plan) : [];
    box.hidden = crew.length < 2;
    const connected = vehicles.value.filter(({ replay }) => !replay);
    const now = JSON.stringify([shown?.record.id, connected.map(({ id, name }) => [id, name])]);
    if (now === key || !shown) return update();
    key = now;
    const before = new Map([...chosen].map(([name, { value }]) => [name, value]));
    chosen.clear();
    const colours = coloursOf(shown.plan, isDark());
    const free = new Set(connected.map(({ id }) => id));
    const match = new Map<string, string>();
    for (const name of crew) {
      const own = connected.find((vehicle) => vehicle.id === before.get(name)) ?? connected.find((vehicle) => vehicle.name === name);
      if (own && free.delete(own.id)) match.set(name, own.id);
    }
    fill(
      rows,
      ...crew.map((name, index) => {
        const select = h("select", { id: `of-${index}`, onchange: update }, h("option", { value: "" }, "–"), ...connected.map((vehicle) => h("option", { value: vehicle.id }, vehicle.name)));
        select.value = match.get(name) ?? "";
        chosen.set(name, select);
        return h("div", { class: "field crew", style: `--c:${colours.get(name) ?? "currentColor"}` }, h("label", { for: `of-${index}` }, name), select);
      }),
    );
    fill(result);
    update();
  };
  open.watch(draw);
  vehicles.watch(draw);
  freshness.watch(update);
  return box;
}
