/**
 * What is looked for, as places that each stand for as much of it: where they drift, and which looks come by.
 *
 * Metres east and north of a middle, seconds of the plan's clock. The same as the judge does it (docs/search.md), of
 * fewer places: a look passes a place when the aircraft is abeam of it.
 */
import type { Geometry, Position as GeoPosition } from "geojson";
import { nearTo, unwrapRings } from "../antimeridian";
import { boundsOf } from "../geo";
import type { RasterGrid } from "../raster/grid";
import type { Member, PlanCollection, Position, Scenario } from "../types";

const RAD = Math.PI / 180;
const METRES_A_DEGREE = 111_195;
export const PLACES = 6000;
/** Of the sequences that places are taken from: as even as can be, the same at each opening. */
const BASES = [2, 3, 5, 7] as const;
const MOST_TRIES = 40;

export type XY = [east_m: number, north_m: number];

export interface Frame {
  lon_deg: number;
  lat_deg: number;
}

const cosine = ({ lat_deg }: Frame): number => Math.cos(lat_deg * RAD);

export const toXY = (frame: Frame, [lon = 0, lat = 0]: GeoPosition): XY => [(nearTo(lon, frame.lon_deg) - frame.lon_deg) * METRES_A_DEGREE * cosine(frame), (lat - frame.lat_deg) * METRES_A_DEGREE];
export const toLonLat = (frame: Frame, [x, y]: XY): Position => [frame.lon_deg + x / (METRES_A_DEGREE * cosine(frame)), frame.lat_deg + y / METRES_A_DEGREE];

interface Source {
  worth: number;
  /** The place of a number from 0 to PLACES, and null where that lies beside the source. */
  at(u: number, v: number): XY | null;
}

/** A place, where it drifts to in a second, and when it was looked at. */
export interface Place {
  at: XY;
  drift_m_s: XY;
  looks_s: number[];
}

export interface LookedFor {
  frame: Frame;
  places: Place[];
  detection: number;
  elapsed_s: number;
  end_s: number;
}

/** Van der Corput's sequence: digits of a number behind the point, the last one first. */
function even(index: number, base: number): number {
  let [value, share] = [0, 1];
  for (let rest = index; rest > 0; rest = Math.floor(rest / base)) {
    share /= base;
    value += share * (rest % base);
  }
  return value;
}

/** Two normal deviates from two even ones (Box and Muller). */
function normal(u: number, v: number): XY {
  const radius = Math.sqrt(-2 * Math.log(Math.max(u, 1e-9)));
  return [radius * Math.cos(2 * Math.PI * v), radius * Math.sin(2 * Math.PI * v)];
}

type Rings = XY[][];

function within([x, y]: XY, rings: Rings): boolean {
  let inside = false;
  for (const ring of rings) {
    for (let i = 0, j = ring.length - 1; i < ring.length; j = i, i += 1) {
      const [[xi, yi], [xj, yj]] = [ring[i] as XY, ring[j] as XY];
      if (yi > y !== yj > y && x < ((xj - xi) * (y - yi)) / (yj - yi) + xi) inside = !inside;
    }
  }
  return inside;
}

function polygonsOf(geometry: Geometry, frame: Frame): Rings[] {
  const all = geometry.type === "Polygon" ? [geometry.coordinates] : geometry.type === "MultiPolygon" ? geometry.coordinates : [];
  return all.map((rings) => unwrapRings(rings).map((ring) => ring.map((place) => toXY(frame, place))));
}

const ringArea = (ring: XY[]): number => Math.abs(ring.reduce((sum, [x, y], i) => sum + x * (ring[(i + 1) % ring.length]?.[1] ?? y) - (ring[(i + 1) % ring.length]?.[0] ?? x) * y, 0)) / 2;

function patch(rings: Rings, score: number): Source {
  const outer = rings[0] ?? [];
  const [xs, ys] = [outer.map(([x]) => x), outer.map(([, y]) => y)];
  const [west, south] = [Math.min(...xs), Math.min(...ys)];
  const [wide, high] = [Math.max(...xs) - west, Math.max(...ys) - south];
  const area_m2 = ringArea(outer) - rings.slice(1).reduce((sum, hole) => sum + ringArea(hole), 0);
  return {
    worth: score * Math.max(0, area_m2),
    at: (u, v) => {
      const place: XY = [west + u * wide, south + v * high];
      return within(place, rings) ? place : null;
    },
  };
}

/** Cells of a raster, the more often the more they are worth; what counts lies in the regions. */
function cells(grid: RasterGrid, regions: Rings[], frame: Frame): Source {
  const [west, south, east, north] = grid.bounds_deg;
  const [wide, high] = [(east - west) / grid.columns, (north - south) / grid.rows];
  const cornerOf = (cell: number, u: number, v: number): XY => toXY(frame, [west + ((cell % grid.columns) + u) * wide, north - (Math.floor(cell / grid.columns) + v) * high]);
  const cell_m2 = wide * high * METRES_A_DEGREE ** 2 * cosine(frame);
  const upTo: number[] = [];
  let worth = 0;
  grid.values.forEach((value, cell) => {
    const middle = cornerOf(cell, 0.5, 0.5);
    if (value !== null && regions.some((rings) => within(middle, rings))) worth += Math.max(0, value) * cell_m2;
    upTo.push(worth);
  });
  return {
    worth,
    at: (u, v) => {
      let [low, high] = [0, upTo.length - 1];
      while (low < high) {
        const middle = (low + high) >> 1;
        if ((upTo[middle] as number) > u * worth) high = middle;
        else low = middle + 1;
      }
      const before = low > 0 ? (upTo[low - 1] as number) : 0;
      return cornerOf(low, (u * worth - before) / ((upTo[low] as number) - before), v);
    },
  };
}

/** What says where it may be: importance where there is some, else every place of the regions alike. */
function sourcesOf(scenario: Scenario, frame: Frame, grid: RasterGrid | null): Source[] {
  const important = scenario.features.filter(({ properties }) => properties.role === "importance");
  const regions = scenario.features.flatMap(({ properties, geometry }) => (properties.role === "roi" ? polygonsOf(geometry, frame) : []));
  if (important.length === 0 && !grid) return regions.map((rings) => patch(rings, 1));
  return [...(grid ? [cells(grid, regions, frame)] : []), ...important.flatMap(({ geometry, properties }): Source[] => {
    const score = Number(properties["score"] ?? 0);
    if (geometry.type !== "Point") return polygonsOf(geometry, frame).map((rings) => patch(rings, score));
    const spread_m = Number(properties["spread_m"] ?? 0);
    const [x, y] = toXY(frame, geometry.coordinates);
    return [{ worth: 2 * Math.PI * spread_m ** 2 * score, at: (u, v) => { const [dx, dy] = normal(u, v); return [x + spread_m * dx, y + spread_m * dy]; } }];
  })];
}

interface Look {
  rings: Rings[];
  /** When the aircraft is abeam of a place. */
  at_s(place: XY): number;
  middle_s: number;
}

function looksOf(plan: PlanCollection, scenario: Scenario, frame: Frame): Look[] {
  const looks = plan.features.flatMap(({ geometry, properties: p }): Look[] => {
    if (p["role"] !== "footprint") return [];
    const collect = plan.features.find(({ properties: c }) => c["role"] === "collect" && c["vehicle"] === p["vehicle"] && c["seq"] === p["seq"]);
    if (!collect || collect.geometry.type !== "LineString") return [];
    const [from, to] = [toXY(frame, collect.geometry.coordinates[0] ?? []), toXY(frame, collect.geometry.coordinates.at(-1) ?? [])];
    const along: XY = [to[0] - from[0], to[1] - from[1]];
    const length2 = along[0] ** 2 + along[1] ** 2;
    const [start_s, end_s] = [Number(collect.properties["start_s"]), Number(collect.properties["end_s"])];
    const at_s = ([x, y]: XY): number => start_s + Math.min(1, Math.max(0, length2 > 0 ? ((x - from[0]) * along[0] + (y - from[1]) * along[1]) / length2 : 0)) * (end_s - start_s);
    return [{ rings: polygonsOf(geometry, frame), at_s, middle_s: (start_s + end_s) / 2 }];
  });
  const before = (scenario["search"] as Member | undefined)?.["seen"];
  return [...looks, ...(Array.isArray(before) ? before : []).map((entry: Member): Look => {
    const [geometry, told] = entry["type"] === "Feature" ? [entry["geometry"], (entry["properties"] as Member | null) ?? {}] : [entry, {}];
    const ago = (told as Member)["ago_s"];
    const [first_s, last_s] = Array.isArray(ago) ? (ago as [number, number]) : [Number(ago ?? 0), Number(ago ?? 0)];
    const middle_s = -(first_s + last_s) / 2;
    return { rings: polygonsOf(geometry as Geometry, frame), at_s: () => middle_s, middle_s };
  })];
}

/** Where a place is at a second. */
export const placeAt_s = ({ at, drift_m_s }: Place, since_s: number): XY => [at[0] + drift_m_s[0] * since_s, at[1] + drift_m_s[1] * since_s];

function looksAt(place: Place, looks: Look[], elapsed_s: number): number[] {
  return looks.flatMap((look) => {
    // Where it is when the aircraft comes by depends on when that is: twice is near enough.
    let at_s = look.middle_s;
    for (let i = 0; i < 2; i += 1) at_s = look.at_s(placeAt_s(place, elapsed_s + at_s));
    const there = placeAt_s(place, elapsed_s + at_s);
    return look.rings.some((rings) => within(there, rings)) ? [at_s] : [];
  });
}

/** Of a search's plan; null where it is none, or a raster says what ground is worth and its grid is not here. */
export function lookedFor(plan: PlanCollection, scenario: Scenario, grid: RasterGrid | null): LookedFor | null {
  if (plan.metrics.area_seen_m2 == null) return null;
  const bounds = boundsOf(scenario.features);
  if (!bounds || (scenario["importance_raster"] !== undefined && !grid)) return null;
  const frame = { lon_deg: (bounds[0] + bounds[2]) / 2, lat_deg: (bounds[1] + bounds[3]) / 2 };
  const sources = sourcesOf(scenario, frame, grid).filter(({ worth }) => worth > 0);
  const whole = sources.reduce((sum, { worth }) => sum + worth, 0);
  if (!(whole > 0)) return null;
  const search = scenario["search"] as Member | undefined;
  const drift = search?.["drift"] as Member | undefined;
  const [speed, toward, uncertain, elapsed_s] = ["speed_m_s", "toward_deg", "spread_m_s", "elapsed_s"].map((name) => Number(drift?.[name] ?? 0)) as [number, number, number, number];
  const mean: XY = [speed * Math.sin(toward * RAD), speed * Math.cos(toward * RAD)];
  const looks = looksOf(plan, scenario, frame);
  const places: Place[] = [];
  for (const source of sources) {
    const wanted = places.length + Math.round((PLACES * source.worth) / whole);
    for (let i = 1, left = MOST_TRIES * PLACES; places.length < wanted && left > 0; i += 1, left -= 1) {
      const at = source.at(even(i, BASES[0]), even(i, BASES[1]));
      if (!at) continue;
      const [dx, dy] = uncertain > 0 ? normal(even(i, BASES[2]), even(i, BASES[3])) : [0, 0];
      const place: Place = { at, drift_m_s: [mean[0] + uncertain * dx, mean[1] + uncertain * dy], looks_s: [] };
      place.looks_s = looksAt(place, looks, elapsed_s);
      places.push(place);
    }
  }
  const end_s = Math.max(0, ...plan.features.flatMap(({ properties: p }) => (p["role"] === "collect" ? [Number(p["end_s"])] : [])));
  return { frame, places, detection: Number(search?.["detection"] ?? 1), elapsed_s, end_s };
}

/** What of each place is left at a second: 1 where nobody has looked. */
export const left = ({ detection }: LookedFor, place: Place, at_s: number): number => (1 - detection) ** place.looks_s.filter((look_s) => look_s <= at_s).length;

/** How much of what there was before take-off is found by a second. */
export function found(looked: LookedFor, at_s: number): number {
  const [before, now] = looked.places.reduce(([b, n], place) => [b + left(looked, place, 0), n + left(looked, place, at_s)], [0, 0]);
  return before > 0 ? 1 - now / before : 0;
}
