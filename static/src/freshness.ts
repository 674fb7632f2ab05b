/** Whether the plan on the map is of the scenario as it is now, and in words why not. */
import { open } from "./plans";
import { scenarios } from "./scenario";
import { Signal } from "./signal";

export interface Freshness {
  state: "none" | "fresh" | "stale";
  /** Empty unless it is stale. */
  reason: string;
}

export const freshness = new Signal<Freshness>({ state: "none", reason: "" });

function judge(): Freshness {
  const shown = open.value;
  if (!shown) return { state: "none", reason: "" };
  if (shown.madeFrom !== scenarios.canonical()) return { state: "stale", reason: "The scenario was edited after this plan was made: plan it again." };
  if (shown.record.stale === true) return { state: "stale", reason: shown.record.stale_reason ?? "Its scenario was changed elsewhere after this plan was made: plan it again." };
  return { state: "fresh", reason: "" };
}

export function keepFresh(): void {
  const update = (): void => {
    const now = judge();
    if (now.state !== freshness.value.state || now.reason !== freshness.value.reason) freshness.set(now);
  };
  open.watch(update);
  scenarios.document.watch(update);
}
