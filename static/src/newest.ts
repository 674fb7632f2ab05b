/** What a new tab begins with: the scenario edited last, or the plan made last, with what belongs to it. */
import { keptScenarios, openKept, refreshKept } from "./keeping";
import { openPlan, recent } from "./plans";
import { scenarios } from "./scenario";

/** Put it on the page, unless the operator has begun with something meanwhile. */
export async function openNewest(): Promise<boolean> {
  const untouched = (): boolean => !scenarios.edited.value && scenarios.document.value.features.length === 0;
  await refreshKept();
  const plan = recent.value.find(({ state }) => state === "done") ?? recent.value.find(({ state }) => state === "queued" || state === "running");
  const kept = keptScenarios.value?.[0];
  if (!untouched()) return false;
  if (kept && (!plan || kept.changed_at > (plan.created_at ?? ""))) {
    if (!(await openKept(kept.id, untouched))) return false;
    await openItsPlan(kept.id);
    return true;
  }
  return plan !== undefined && openPlan(plan.id, false, untouched);
}

/** The newest plan made of a kept scenario, beside that scenario as it is now. */
export async function openItsPlan(id: string): Promise<void> {
  const made = recent.value.find((record) => record.scenario_id === id && record.state === "done");
  if (made) await openPlan(made.id, true);
}
