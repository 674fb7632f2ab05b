import type { Feature } from "geojson";
import { ApiError, apiUrl, connection, follow, get, list, post, remove } from "./api";
import { canonical } from "./canonical";
import { encoding, queryOf } from "./encoding";
import { circleRing } from "./geo";
import { adoptIfSame, keeping, keepNow } from "./keeping";
import { itemsOf, type MissionItem } from "./mission";
import { coloursOf } from "./crew/flights";
import { attempt, news, report } from "./notices";
import type { Replan } from "./replanning";
import { scenarios } from "./scenario";
import { Signal } from "./signal";
import type { PlanCollection, PlanRecord, PlanState, Position, Problem, Scenario } from "./types";

export interface OpenPlan {
  record: PlanRecord;
  plan: PlanCollection;
  /** Empty when the plan cannot be said as a mission. */
  items: MissionItem[];
  /** The scenario it was made of, as documents are compared. */
  madeFrom: string;
}

/** The plan being made, if any; the plan on the map, if any; those the service knows, newest first. */
export const running = new Signal<PlanRecord | null>(null);
export const open = new Signal<OpenPlan | null>(null);
/** The plan that is on its way onto the map. */
export const coming = new Signal<string | null>(null);
export const recent = new Signal<PlanRecord[]>([]);
/** The plan beside which the one on the map is looked at. */
export const compared = new Signal<{ record: PlanRecord; plan: PlanCollection } | null>(null);

const ENDED: ReadonlySet<PlanState> = new Set(["done", "failed", "cancelled"]);

export const planUrl = (id: string, file: string): string => apiUrl(`/plans/${encodeURIComponent(id)}/${file}`);

export async function refresh(): Promise<void> {
  const records = await list<PlanRecord>("/plans", "plans");
  const sorted = [...records].sort((a, b) => (b.created_at ?? "").localeCompare(a.created_at ?? ""));
  // Where nothing is other nothing is drawn anew: what is pointed at stays.
  if (JSON.stringify(sorted) !== JSON.stringify(recent.value)) recent.set(sorted);
}

/** What went wrong with a plan, as a problem document. */
export function problemOf(record: PlanRecord): Problem | null {
  if (!record.error) return null;
  return typeof record.error === "string" ? { title: "Planning failed", detail: record.error } : record.error;
}

async function readItems(id: string): Promise<MissionItem[]> {
  const document = await attempt("The mission's waypoints cannot be shown", () => get<unknown>(`/plans/${encodeURIComponent(id)}/mission.plan${queryOf(encoding.value)}`));
  return itemsOf(document);
}

/**
 * Bring a plan onto the map; its scenario too, unless that of the page stays (`beside`). False when `wanted`
 * says, once the answers are there, that the operator has gone on with something else.
 */
export async function openPlan(id: string, beside = false, wanted = (): boolean => true): Promise<boolean> {
  coming.set(id);
  try {
    return await bring(id, beside, wanted);
  } finally {
    if (coming.value === id) coming.set(null);
  }
}

async function bring(id: string, beside: boolean, wanted: () => boolean): Promise<boolean> {
  const path = `/plans/${encodeURIComponent(id)}`;
  const before = scenarios.replaced.value;
  const record = await get<PlanRecord>(path);
  const done = record.state === "done";
  const scenario = await get<Scenario>(`${path}/scenario`);
  const plan = done ? await get<PlanCollection>(`${path}/plan.geojson`) : null;
  const items = done ? await readItems(id) : [];
  // Another scenario was opened meanwhile: this plan is no longer asked for.
  if (!wanted() || scenarios.replaced.value !== before) return false;
  const madeFrom = canonical(scenario);
  if (!beside && madeFrom !== scenarios.canonical()) scenarios.load(scenario, false);
  running.set(done ? null : record);
  if (compared.value?.record.id === id) compared.set(null);
  open.set(plan ? { record, plan, items, madeFrom } : null);
  if (!ENDED.has(record.state)) watchPlan(record);
  if (record.stale !== true) await attempt("Whether the plan's scenario is kept could not be read", () => adoptIfSame(record.scenario_id));
  return true;
}

/** Read the items anew where how the mission is written was changed. */
export async function rereadItems(): Promise<void> {
  const shown = open.value;
  if (!shown) return;
  const items = await readItems(shown.record.id);
  if (open.value?.record.id === shown.record.id) open.set({ ...open.value, items });
}

/** Ask whether the plan on the map still is of its kept scenario as that one is now. */
export async function refreshOpen(): Promise<void> {
  const shown = open.value;
  if (!shown || shown.record.stale === undefined) return;
  const record = await get<PlanRecord>(`/plans/${encodeURIComponent(shown.record.id)}`);
  const still = open.value;
  if (still?.record.id === record.id && (still.record.stale !== record.stale || still.record.stale_reason !== record.stale_reason)) open.set({ ...still, record });
}

/** Choose the plan to compare with; null for none. */
export async function compareWith(id: string | null): Promise<void> {
  if (id === null) return compared.set(null);
  const path = `/plans/${encodeURIComponent(id)}`;
  const [record, plan] = await Promise.all([get<PlanRecord>(path), get<PlanCollection>(`${path}/plan.geojson`)]);
  compared.set({ record, plan });
}

let unwatch: (() => void) | null = null;

/** `own`: a plan that was made of another scenario than the page's comes with that. */
function ended(id: string, own: boolean): void {
  unwatch?.();
  unwatch = null;
  const before = scenarios.replaced.value;
  void attempt("The plan's outcome could not be read", async () => {
    const record = await get<PlanRecord>(`/plans/${encodeURIComponent(id)}`);
    if (scenarios.replaced.value === before) {
      running.set(record);
      if (record.state === "done") {
        await openPlan(id, !own);
        if (record.metrics?.lower_bound_m == null) watchBound(id);
      } else if (record.state === "failed") {
        const problem = problemOf(record) ?? { title: "Planning failed" };
        report("Planning failed", new ApiError(problem.status ?? 0, problem));
      }
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

function watchPlan(record: PlanRecord, own = false): void {
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
        ended(record.id, own);
      }
    },
    () => undefined,
    (error) => report("The plan's progress cannot be followed", error),
  );
}

export async function startPlan(): Promise<void> {
  const before = scenarios.replaced.value;
  const document = scenarios.document.value;
  await keepNow();
  const { id } = keeping.value;
  const record = await post<PlanRecord>(`/plans${id === null ? "" : `?scenario_id=${encodeURIComponent(id)}`}`, document);
  if (scenarios.replaced.value === before) {
    running.set(record);
    watchPlan(record);
  } else {
    news("The plan of the scenario before goes on; it will stand under Recent plans.");
  }
  await refresh();
}

/** Plan what is left of a plan; once it is made it is shown with the scenario that is left. */
export async function startReplan(id: string, body: Replan): Promise<void> {
  const before = scenarios.replaced.value;
  // What was edited stays with the scenario it was edited in.
  await keepNow();
  const record = await post<PlanRecord>(`/plans/${encodeURIComponent(id)}/replan`, body);
  if (scenarios.replaced.value === before) {
    running.set(record);
    watchPlan(record, true);
  } else {
    news("The plan of what is left goes on; it will stand under Recent plans.");
  }
  await refresh();
}

const CHECK_MS = 5000;

/** Ask again every while, and whenever an edit of this tab has been kept; plans that others posted are listed then, too. */
export function keepOpenFresh(): void {
  const look = async (): Promise<void> => {
    try {
      await refresh();
      await refreshOpen();
    } catch {
      // The loss of the service shows by itself; a plan deleted elsewhere goes with the next listing.
      return;
    }
  };
  keeping.watch(({ state }) => state === "kept" && void look());
  setInterval(() => connection.value === "up" && !document.hidden && void look(), CHECK_MS);
}

/** Nothing of another scenario stays on the page: its plan, the one being made, the one beside it. */
export function keepToTheScenario(): void {
  scenarios.replaced.watch(() => {
    unwatch?.();
    unwatch = null;
    running.set(null);
    open.set(null);
    coming.set(null);
    compared.set(null);
  });
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
/** Whether it sees as much as it can, not all. */
export const isSearch = ({ metrics }: PlanCollection): boolean => metrics.area_seen_m2 != null;

export function planFeatures(plan: PlanCollection, dark = false): Feature[] {
  const colours = coloursOf(plan, dark);
  return numbered(plan).map((feature) => {
    const colour = colours.get(String(feature.properties?.["vehicle"] ?? ""));
    return colour === undefined ? feature : { ...feature, properties: { ...feature.properties, colour } };
  });
}

function numbered(plan: PlanCollection): Feature[] {
  const numbers = new Map<Feature, number>();
  const collects = plan.features.filter((feature) => feature.properties?.["role"] === "collect");
  collects.sort((a, b) => Number(a.properties?.["start_m"] ?? 0) - Number(b.properties?.["start_m"] ?? 0));
  // Each aircraft counts its own.
  const several = new Set(collects.map((collect) => collect.properties?.["vehicle"])).size > 1;
  collects.forEach((collect, index) => numbers.set(collect, several ? Number(collect.properties?.["seq"] ?? index + 1) : index + 1));
  const photographed = new Set((plan.cameras ?? []).filter(({ trigger }) => trigger !== "video").map(({ name }) => name));
  // Photos have a source of their own.
  return plan.features.filter((feature) => feature.properties?.["role"] !== "photos").map((feature) => {
    if (feature.properties["role"] === "footprint" && photographed.has(String(feature.properties["sensor"]))) {
      return { ...feature, properties: { ...feature.properties, of_photos: true } };
    }
    if (feature.properties["role"] === "uncovered" && isSearch(plan)) return { ...feature, properties: { ...feature.properties, searched: true } };
    const place = numbers.get(feature);
    const { role, radius_m } = feature.properties ?? {};
    if (role === "fence" && feature.geometry.type === "Point" && typeof radius_m === "number") {
      return { ...feature, geometry: { type: "Polygon", coordinates: [circleRing(feature.geometry.coordinates as Position, radius_m)] } };
    }
    return place === undefined ? feature : { ...feature, properties: { ...feature.properties, label: String(place) } };
  });
}
