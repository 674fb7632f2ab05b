/** What a reload of this tab brings back: its scenario, where that is kept, and its plan. Other tabs have their own. */
import { keeping, resume, type Keeping } from "./keeping";
import { coming, open } from "./plans";
import { parseScenario, scenarios } from "./scenario";
import type { Signal } from "./signal";

const KEY = "swathplan.page";
/** Of a former release, shared by all tabs. */
const FORMER_KEY = "swathplan.scenario";

interface Saved {
  text: string;
  edited: boolean;
  kept: Keeping;
  plan: string | null;
  /** Which part of the panel was open; absent where a former release wrote it. */
  panel?: string;
}

/** Bring back what the tab had; the plan that was on the map, if any, and the part of the panel that was open; null when there is nothing. */
export function restore(): { plan: string | null; panel: string | null } | null {
  const former = localStorage.getItem(FORMER_KEY);
  localStorage.removeItem(FORMER_KEY);
  try {
    const found = sessionStorage.getItem(KEY);
    const saved = found !== null ? (JSON.parse(found) as Saved) : former !== null ? { text: former, edited: true, kept: { id: null, tag: "", state: "waiting" as const }, plan: null } : null;
    if (!saved) return null;
    scenarios.load(parseScenario(saved.text), saved.edited);
    resume(saved.kept);
    return { plan: saved.plan, panel: saved.panel ?? null };
  } catch {
    // Not of this release, or cut off: there is nothing to bring back.
    sessionStorage.removeItem(KEY);
    return null;
  }
}

/** Write it down with every change. */
export function keepSession(panel: Signal<string>): void {
  const write = (): void => {
    const nothing = scenarios.document.value.features.length === 0 && !scenarios.edited.value && open.value === null;
    if (nothing) return sessionStorage.removeItem(KEY);
    const saved: Saved = { text: scenarios.text(), edited: scenarios.edited.value, kept: keeping.value, plan: open.value?.record.id ?? coming.value, panel: panel.value };
    try {
      sessionStorage.setItem(KEY, JSON.stringify(saved));
    } catch {
      // A full or forbidden storage loses only what a reload would bring back.
      sessionStorage.removeItem(KEY);
    }
  };
  for (const signal of [scenarios.document, scenarios.edited, keeping, open, panel]) (signal as { watch(listener: () => void): unknown }).watch(write);
}
