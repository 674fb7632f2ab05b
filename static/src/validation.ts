/** The service's judgement of the scenario, asked for whenever it has rested for a moment. */
import { ApiError, connection, NoConnection, post, readFindings } from "./api";
import { report } from "./notices";
import { scenarios } from "./scenario";
import { debounce, Signal } from "./signal";
import type { Finding } from "./types";

const QUIET_MS = 700;

export interface Judgement {
  state: "empty" | "asking" | "sound" | "refused" | "unknown";
  findings: Finding[];
}

export const judgement = new Signal<Judgement>({ state: "empty", findings: [] });

let asked = 0;

export async function judge(): Promise<void> {
  const ticket = (asked += 1);
  const tell = (result: Judgement): void => {
    if (ticket === asked) judgement.set(result);
  };
  if (scenarios.document.value.features.length === 0) return tell({ state: "empty", findings: [] });
  try {
    const answer = await post<{ findings?: unknown }>("/scenarios/validate", scenarios.document.value);
    tell({ state: "sound", findings: readFindings(answer?.findings) });
  } catch (error) {
    if (error instanceof ApiError && error.status === 422) {
      const findings = error.errors.length > 0 ? error.errors : readFindings([{ feature: "scenario", message: error.message, rule: error.problem.title }]);
      return tell({ state: "refused", findings });
    }
    tell({ state: "unknown", findings: [] });
    if (!(error instanceof NoConnection)) report("The scenario could not be checked", error);
  }
}

/** Check after every change, and again when the service is back. */
export function keepJudging(): void {
  const soon = debounce(() => void judge(), QUIET_MS);
  scenarios.document.watch(({ features }) => {
    // What was said of the scenario before says nothing of it now.
    judgement.set({ state: features.length > 0 ? "asking" : "empty", findings: features.length > 0 ? judgement.value.findings : [] });
    soon();
  });
  connection.watch((state) => {
    if (state === "up" && judgement.value.state === "unknown") soon();
  });
}
