/** Planning anew in flight: what is left of the plan on the map, with what was changed on the page since. */
import { ApiError } from "../api";
import { clock_s } from "../crew/clock";
import { crewOf } from "../crew/flights";
import { button, fill, h, section } from "../dom";
import { vehicles } from "../fleet";
import { inFlight } from "../holding";
import { findingText, report } from "../notices";
import { open, running, startReplan, type OpenPlan } from "../plans";
import { differences, wordsOf, type Differences, type Replan } from "../replanning";
import { scenarios } from "../scenario";
import type { Scenario, Vehicle } from "../types";

const MOVING = new Set(["queued", "running"]);

/** Connected vehicles that fly the plan on the map now. */
function flyers(): Vehicle[] {
  const id = open.value?.record.id;
  return vehicles.value.filter((vehicle) => !vehicle.replay && vehicle.flight_id !== null && vehicle.plan_id === id && inFlight(vehicle));
}

/** What the page's scenario has since become other than the one of the plan. */
const since = ({ madeFrom }: OpenPlan): Differences => differences(JSON.parse(madeFrom) as Scenario, scenarios.document.value);

/** What a plan made in flight has kept of the order before it; empty of others. */
function keptWords({ metrics: { replan } }: OpenPlan["plan"]): string {
  if (!replan) return "";
  const part = (word: string, names: string[]): string => (names.length > 0 ? `; ${word}: ${names.join(", ")}` : "");
  return `This plan was made in flight: ${replan.kept.length} regions kept in their order${part("moved", replan.moved)}${part("new", replan.new)}.`;
}

export function replanBox(): HTMLElement {
  const changes = h("ul", { id: "replan-changes" });
  /** Of a plan that was made so: what it has kept. */
  const kept = h("p", { class: "quiet", id: "replan-kept" });
  const from = h("select", { id: "replan-from" });
  const minutes = h("input", { id: "replan-min", type: "number", min: 0, step: "any", value: 0 });
  const when = h("div", { class: "field" }, h("label", { for: "replan-min" }, "Minutes after its beginning"), minutes);
  const lost = h("div", { class: "grid", id: "replan-lost" });
  const why = h("p", { class: "quiet", id: "replan-why" });
  const answer = h("div", { "aria-live": "polite" });
  const go = button("Plan what is left", () => void send(), { class: "primary", id: "replan" });
  const box = section(
    "Change in flight",
    false,
    h("p", { class: "quiet" }, "Draw what is new, move or delete what changed under Scenario; the plan is then made anew from where its aircraft are, for what they have not seen. Nothing is sent to them until you upload it."),
    kept,
    changes,
    h("div", { class: "grid" }, h("div", { class: "field" }, h("label", { for: "replan-from" }, "From"), from), when),
    lost,
    h("div", { class: "row" }, go),
    why,
    answer,
  );
  box.id = "replan-box";
  const ticks = new Map<string, HTMLInputElement>();
  let asking = false;
  /** What the operator said; else it follows whether any of them flies. */
  let chosen = "";

  const send = async (): Promise<void> => {
    const shown = open.value;
    if (!shown) return;
    const { add, remove, wind } = since(shown);
    const body: Replan = { add, remove, lost: [...ticks].filter(([, tick]) => tick.checked).map(([name]) => name) };
    if (wind !== undefined) body.wind = wind;
    if (from.value === "plan") body.at_s = Number(minutes.value) * 60;
    asking = true;
    fill(answer);
    update();
    try {
      await startReplan(shown.record.id, body);
    } catch (error) {
      if (error instanceof ApiError) fill(answer, h("ul", { class: "findings" }, h("li", { class: "error" }, error.message), ...error.errors.map((finding) => h("li", { class: "error" }, findingText(finding)))));
      report("It was not planned anew", error);
    } finally {
      asking = false;
      update();
    }
  };
  const refusal = ({ refused }: Differences): string => {
    if (refused.length > 0) return `What flies cannot take over what you changed of: ${[...new Set(refused)].join(", ")}. Undo that, or plan the whole scenario for a start from the ground.`;
    if (from.value === "plan" && (!minutes.checkValidity() || minutes.value === "")) return "Say at which minute of the plan.";
    if (ticks.size > 0 && [...ticks.values()].every(({ checked }) => checked)) return "No aircraft is left.";
    return "";
  };
  const update = (): void => {
    const shown = open.value;
    if (!shown) return;
    const other = since(shown);
    const found = wordsOf(other);
    fill(changes, ...(found.length > 0 ? found : ["nothing was changed: only what has been seen is left out"]).map((words) => h("li", {}, words)));
    when.hidden = from.value !== "plan";
    const busy = asking || (running.value !== null && MOVING.has(running.value.state));
    const words = refusal(other);
    go.disabled = busy || words !== "";
    fill(go, asking ? "Asking the service …" : "Plan what is left");
    if (why.textContent !== words) why.textContent = words;
  };
  let drawn: string | null = null;
  /** Of another plan: its aircraft, and nothing chosen yet. */
  const redraw = ({ record, plan }: OpenPlan): void => {
    drawn = record.id;
    chosen = "";
    minutes.value = "0";
    ticks.clear();
    fill(kept, keptWords(plan));
    kept.hidden = plan.metrics.replan === undefined;
    const crew = crewOf(plan);
    fill(
      lost,
      ...(crew.length < 2 ? [] : crew).map((name, index) => {
        const tick = h("input", { id: `lost-${index}`, type: "checkbox", onchange: update });
        ticks.set(name, tick);
        return h("div", { class: "field tick" }, tick, h("label", { for: `lost-${index}` }, `${name} flies no more`));
      }),
    );
    fill(answer);
  };
  let flying: string | null = null;
  const draw = (): void => {
    const shown = open.value;
    box.hidden = shown === null;
    if (!shown) return;
    const other = shown.record.id !== drawn;
    if (other) redraw(shown);
    const names = flyers().map(({ name }) => name).join(", ");
    if (other || names !== flying) {
      flying = names;
      fill(from, names ? h("option", { value: "flights" }, "where they are now") : null, h("option", { value: "plan" }, "the plan, at a time"));
      from.title = names ? `In flight: ${names}` : "None of them is known to fly this plan";
      from.value = names && chosen !== "plan" ? "flights" : "plan";
      if (names) box.open = true;
    }
    update();
  };
  from.addEventListener("change", () => {
    chosen = from.value;
    update();
  });
  minutes.addEventListener("input", update);
  // The slider of the plan's clock says when, too.
  clock_s.watch((at_s) => {
    if (at_s !== null && document.activeElement !== minutes) minutes.value = (at_s / 60).toFixed(2);
  });
  open.watch(draw);
  vehicles.watch(draw);
  scenarios.document.watch(update);
  running.watch(update);
  return box;
}
