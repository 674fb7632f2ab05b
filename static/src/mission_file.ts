/** Mission files of other programs: the service reads and judges one, and it is shown as a plan. */
import { ApiError, sendFile } from "./api";
import { keeping, keepNow } from "./keeping";
import { mayLeave } from "./leaving";
import { news, report } from "./notices";
import { openPlan, refresh } from "./plans";
import type { PlanRecord } from "./types";
import { judgement } from "./validation";

/** Files that the service reads as missions. */
export const MISSION_FILES = ".plan,.mission,.waypoints";
const ROWS = /^\s*QGC WPL/;
/** Why a mission is not judged in the scenario on the page, but by its own fence alone. */
const ELSEWHERE = "elsewhere";

/** Whether a file is a mission, by its name, or as a text that begins like one. */
export async function isMissionFile(file: File): Promise<boolean> {
  const name = file.name.toLowerCase();
  if (MISSION_FILES.split(",").some((ending) => name.endsWith(ending))) return true;
  return name.endsWith(".txt") && ROWS.test(await file.slice(0, 64).text());
}

/** Show a mission file's items, fence and rally points; judged in the page's scenario where that one is sound. */
export async function openMission(file: File): Promise<boolean> {
  try {
    const scenarioId = await soundScenario();
    const inIt = scenarioId === null ? null : await judgedIn(file, scenarioId);
    if (inIt === null && !(await mayLeave(`Open ${file.name}?`, "Open"))) return false;
    const record = inIt ?? (await taken(file, {}));
    if (!(await openPlan(record.id, inIt !== null))) return false;
    const judged = inIt ? "judged in the scenario on the page" : "judged by its own fence alone";
    news(`Opened ${file.name}, ${judged}.`, ...(record.warnings ?? []).map(({ message }) => message));
    await refresh();
    return true;
  } catch (error) {
    report(`${file.name} was not opened`, error);
    return false;
  }
}

/** The id under which the page's scenario is kept as it is now, where the service accepts it. */
async function soundScenario(): Promise<string | null> {
  await keepNow();
  const { id, state } = keeping.value;
  return judgement.value.state === "sound" && (state === "kept" || state === "shown") ? id : null;
}

async function judgedIn(file: File, scenarioId: string): Promise<PlanRecord | null> {
  try {
    return await taken(file, { scenario_id: scenarioId });
  } catch (error) {
    if (error instanceof ApiError && error.errors.some(({ rule }) => rule === ELSEWHERE)) return null;
    throw error;
  }
}

function taken(file: File, how: Record<string, string>): Promise<PlanRecord> {
  const name = file.name.replace(/\.(plan|mission|waypoints|txt)$/i, "");
  return sendFile<PlanRecord>(`/plans/import?${new URLSearchParams({ name, ...how })}`, file);
}
