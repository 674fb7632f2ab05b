/** Plans: asking for one, following its progress, opening one that was made before. */
import type { Feature } from "geojson";
import { ApiError, apiUrl, follow, get, list, post, remove } from "./api";
import { attempt, report } from "./notices";
import { scenarios } from "./scenario";
import { Signal } from "./signal";
import type { PlanCollection, PlanRecord, PlanState, Position, Problem, Scenario } from "./types";

export interface OpenPlan {
  record: PlanRecord;
  plan: PlanCollection;
  waypoints: Position[];
  /** The scenario's text when the plan was asked for or opened; null when it is not the one on the page. */
  madeFrom: string | null;
}

/** The plan being made, if any; the plan on the map, if any; those the service knows, newest first. */
export const running = new Signal<PlanRecord | null>(null);
export const open = new Signal<OpenPlan | null>(null);
export const recent = new Signal<PlanRecord[]>([]);
/** The plan beside which the one on the map is looked at. */
export const compared = new Signal<{ record: PlanRecord; plan: PlanCollection } | null>(null);

const ENDED: ReadonlySet<PlanState> = new Set(["done", "failed", "cancelled"]);
const NAV_WAYPOINT = 16;

export const planUrl = (id: string, file: string): string => apiUrl(`/plans/${encodeURIComponent(id)}/${file}`);

export async function refresh(): Promise<void> {
  const records = await list<PlanRecord>("/plans", "plans");
  recent.set([...records].sort((a, b) => (b.created_at ?? "").localeCompare(a.created_at ?? "")));
}

/** What went wrong with a plan, as a problem document. */
export function problemOf(record: PlanRecord): Problem | null {
  if (!record.error) return null;
  return typeof record.error === "string" ? { title: "Planning failed", detail: record.error } : record.error;
}

interface QgcItem {
  command?: number;
  params?: (number | null)[];
}

/** The waypoints of a QGroundControl plan, as longitude and latitude. */
export function waypointsOf(document: unknown): Position[] {
  const items = (document as { mission?: { items?: QgcItem[] } } | null)?.mission?.items ?? [];
  return items
    .filter((item) => item.command === NAV_WAYPOINT && (item.params?.length ?? 0) >= 6)
    .map((item) => [Number(item.params?.[5]), Number(item.params?.[4])] as Position)
    .filter(([lon, lat]) => Number.isFinite(lon) && Number.isFinite(lat) && (lon !== 0 || lat !== 0));
}

/**
 * Bring a plan onto the map; its scenario too, unless `madeFrom` tells that of the page. False when `wanted`
 * says, once the answers are there, that the operator has gone on with something else.
 */
export async function openPlan(id: string, madeFrom: string | null = null, wanted = (): boolean => true): Promise<boolean> {
  const path = `/plans/${encodeURIComponent(id)}`;
  const record = await get<PlanRecord>(path);
  const done = record.state === "done";
  const scenario = madeFrom === null ? await get<Scenario>(`${path}/scenario`) : null;
  const plan = done ? await get<PlanCollection>(`${path}/plan.geojson`) : null;
  const mission = done ? await attempt("The mission's waypoints cannot be shown", () => get<unknown>(`${path}/mission.plan`)) : null;
  if (!wanted()) return false;
  if (scenario) scenarios.load(scenario, false);
  const text = madeFrom ?? scenarios.text();
  running.set(done ? null : record);
  if (compared.value?.record.id === id) compared.set(null);
  open.set(plan ? { record, plan, waypoints: waypointsOf(mission), madeFrom: text } : null);
  if (!ENDED.has(record.state)) watchPlan(record, text);
  return true;
}

/** Choose the plan to compare with; null for none. */
export async function compareWith(id: string | null): Promise<void> {
  if (id === null) return compared.set(null);
  const path = `/plans/${encodeURIComponent(id)}`;
  const [record, plan] = await Promise.all([get<PlanRecord>(path), get<PlanCollection>(`${path}/plan.geojson`)]);
  compared.set({ record, plan });
}

let unwatch: (() => void) | null = null;

function ended(id: string, madeFrom: string): void {
  unwatch?.();
  unwatch = null;
  void attempt("The plan's outcome could not be read", async () => {
    const record = await get<PlanRecord>(`/plans/${encodeURIComponent(id)}`);
    running.set(record);
    if (record.state === "done") {
      await openPlan(id, madeFrom);
      if (record.metrics?.lower_bound_m == null) watchBound(id);
      if (scenarios.text() === madeFrom) scenarios.handedOver();
    } else if (record.state === "failed") {
      const problem = problemOf(record) ?? { title: "Planning failed" };
      report("Planning failed", new ApiError(problem.status ?? 0, problem));
    }
    await refresh();
  });
}

/** The plan is there before what no plan is shorter than: put that beside it when it comes. */
function watchBound(id: string): void {
  let seen = 0;
  const stop = follow(
    `/plans/${encodeURIComponent(id)}/events`,
    ({ event, data }) => {
      const { metrics } = data as Partial<PlanRecord>;
      const shown = open.value;
      if (metrics?.lower_bound_m != null && shown?.record.id === id) {
        open.set({ ...shown, plan: { ...shown.plan, metrics: { ...shown.plan.metrics, ...metrics } } });
      }
      // A stream that begins again has ended without one.
      if (event === "bound" || ++seen > 1 || shown?.record.id !== id) stop();
    },
    () => undefined,
    () => undefined,
  );
}

function watchPlan(record: PlanRecord, madeFrom: string): void {
  unwatch?.();
  let over = false;
  unwatch = follow(
    `/plans/${encodeURIComponent(record.id)}/events`,
    ({ data }) => {
      const update = data as Partial<PlanRecord> & { fraction?: number };
      if (!update || typeof update !== "object" || over) return;
      const merged = { ...(running.value ?? record), ...update, id: record.id };
      if (update.progress === undefined && update.fraction !== undefined) merged.progress = update.fraction;
      running.set(merged);
      if (ENDED.has(merged.state)) {
        over = true;
        ended(record.id, madeFrom);
      }
    },
    () => undefined,
    (error) => report("The plan's progress cannot be followed", error),
  );
}

export async function startPlan(): Promise<void> {
  const madeFrom = scenarios.text();
  const record = await post<PlanRecord>("/plans", scenarios.document.value);
  running.set(record);
  watchPlan(record, madeFrom);
  await refresh();
}

export async function cancelPlan(): Promise<void> {
  const record = running.value;
  if (record) await remove(`/plans/${encodeURIComponent(record.id)}`);
}

/** Delete a plan that has ended; it leaves the map when it is there. */
export async function deletePlan(id: string): Promise<void> {
  await remove(`/plans/${encodeURIComponent(id)}`);
  if (open.value?.record.id === id) open.set(null);
  if (compared.value?.record.id === id) compared.set(null);
  if (running.value?.id === id) running.set(null);
  await refresh();
}

/** Plan features for the map: collects carry the number of their place in flight order. */
export function planFeatures(plan: PlanCollection): Feature[] {
  const numbers = new Map<Feature, number>();
  const collects = plan.features.filter((feature) => feature.properties?.["role"] === "collect");
  collects.sort((a, b) => Number(a.properties?.["start_m"] ?? 0) - Number(b.properties?.["start_m"] ?? 0));
  collects.forEach((collect, index) => numbers.set(collect, index + 1));
  return plan.features.map((feature) => {
    const place = numbers.get(feature);
    return place === undefined ? feature : { ...feature, properties: { ...feature.properties, label: String(place) } };
  });
}
