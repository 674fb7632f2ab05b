/** Who flies what and when: every flight of a plan on one clock, and the colour of its aircraft. */
import type { Position as GeoPosition } from "geojson";
import { unwrapLine } from "../antimeridian";
import { distance_m } from "../geo";
import { pathsOf, step_m } from "../phases";
import type { Phase, PlanCollection, Position } from "../types";

/** Told apart also by those who see no red or green (Okabe and Ito), then by their order. */
const COLOURS = {
  light: ["#0072b2", "#d55e00", "#7a3fb0", "#00805c", "#b3006b", "#6b5b00", "#3b6ea8", "#8a3b12"],
  dark: ["#56b4e9", "#ff9d4d", "#c39bff", "#3ddcae", "#ff7cc3", "#e6d25a", "#9cc9f5", "#e8a27c"],
} as const;

export interface Pass {
  seq: number;
  roi: string;
  sensor: string;
  start_s: number;
  end_s: number;
}

export interface Flight {
  vehicle: string;
  sortie: number;
  type: string;
  start_s: number;
  end_s: number;
  phases: Phase[];
  passes: Pass[];
  /** How far along its line it is at which second. */
  knots: { at_s: number; at_m: number }[];
  line: GeoPosition[];
  along_m: number[];
}

/** The aircraft of a plan in its own order. */
export function crewOf(plan: PlanCollection): string[] {
  const flying = new Set(pathsOf(plan).map(({ properties }) => String(properties?.["vehicle"] ?? "")));
  const named = (plan.vehicles ?? []).map(({ name }) => name).filter((name) => flying.has(name));
  return [...named, ...[...flying].filter((name) => !named.includes(name))];
}

/** The place among the colours that a name was given: an aircraft keeps its own from plan to plan. */
const given = new Map<string, number>();

/** The colour of each aircraft; none where there is one alone that never had company. */
export function coloursOf(plan: PlanCollection, dark: boolean): Map<string, string> {
  const crew = crewOf(plan);
  const colours = COLOURS[dark ? "dark" : "light"];
  if (crew.length < 2 && !crew.some((name) => given.has(name))) return new Map();
  const used = new Set<number>();
  const places = new Map<string, number>();
  for (const name of crew) {
    const own = given.get(name);
    if (own === undefined || used.has(own)) continue;
    used.add(own);
    places.set(name, own);
  }
  for (const name of crew) {
    if (places.has(name)) continue;
    const free = colours.findIndex((_, index) => !used.has(index));
    const place = free < 0 ? places.size % colours.length : free;
    used.add(place);
    places.set(name, place);
    given.set(name, place);
  }
  return new Map(crew.map((name) => [name, colours[places.get(name) ?? 0] as string]));
}

export function flightsOf(plan: PlanCollection): Flight[] {
  const types = new Map((plan.vehicles ?? []).map(({ name, type }) => [name, type as string]));
  const order = crewOf(plan);
  const flights = pathsOf(plan).map(({ geometry, properties }): Flight => {
    const of = (name: string): unknown => properties?.[name];
    const [vehicle, sortie] = [String(of("vehicle") ?? ""), Number(of("sortie") ?? 1)];
    const phases = (of("phases") as Phase[] | undefined) ?? [];
    const start_s = Number(of("start_s") ?? phases[0]?.start_s ?? 0);
    const end_s = phases.at(-1)?.end_s ?? start_s + Number(of("duration_s") ?? 0);
    const collects = plan.features.filter(
      ({ properties: p }) => p["role"] === "collect" && p["vehicle"] === vehicle && Number(p["start_s"]) >= start_s - 1 && Number(p["end_s"]) <= end_s + 1,
    );
    const line = unwrapLine(geometry.coordinates);
    const along_m = [0];
    for (let i = 1; i < line.length; i += 1) along_m.push((along_m[i - 1] as number) + step_m(line[i - 1] as GeoPosition, line[i] as GeoPosition));
    // The plan measures along the true line; the map's vertices a little less of it.
    const length_m = Number(of("length_m") ?? 0) || (along_m.at(-1) as number);
    const scale = (along_m.at(-1) as number) / length_m;
    const told = [...phases, ...collects.map(({ properties: p }) => p as unknown as Phase)];
    const knots = told.flatMap((one) => [
      { at_s: Number(one.start_s), at_m: Number(one.start_m) * scale },
      { at_s: Number(one.end_s), at_m: Number(one.end_m) * scale },
    ]);
    if (knots.length === 0) knots.push({ at_s: start_s, at_m: 0 }, { at_s: end_s, at_m: along_m.at(-1) as number });
    knots.sort((a, b) => a.at_s - b.at_s || a.at_m - b.at_m);
    const passes = collects.map(({ properties: p }) => ({ seq: Number(p["seq"]), roi: String(p["roi"]), sensor: String(p["sensor"]), start_s: Number(p["start_s"]), end_s: Number(p["end_s"]) }));
    return { vehicle, sortie, type: types.get(vehicle) ?? "fixed_wing", start_s, end_s, phases, passes, knots, line, along_m };
  });
  return flights.sort((a, b) => order.indexOf(a.vehicle) - order.indexOf(b.vehicle) || a.start_s - b.start_s);
}

export interface Place {
  at: Position;
  altitude_m: number | null;
  heading_deg: number;
}

/** The first index whose value is not less. */
function lower(values: number[], value: number): number {
  let [low, high] = [0, values.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if ((values[middle] as number) < value) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** Where a flight is at a second of the plan's clock; null before take-off and after landing. */
export function placeAt(flight: Flight, at_s: number): Place | null {
  const { knots, line, along_m } = flight;
  if (at_s < flight.start_s || at_s > flight.end_s || line.length < 2) return null;
  const after = Math.min(knots.length - 1, Math.max(1, knots.findIndex((knot) => knot.at_s >= at_s)));
  const [from, to] = [knots[after - 1], knots[after]];
  if (!from || !to) return null;
  const t = to.at_s > from.at_s ? Math.min(1, Math.max(0, (at_s - from.at_s) / (to.at_s - from.at_s))) : 1;
  const along = from.at_m + t * (to.at_m - from.at_m);
  const index = Math.min(line.length - 1, Math.max(1, lower(along_m, along)));
  const [a, b] = [line[index - 1] as GeoPosition, line[index] as GeoPosition];
  const span = (along_m[index] as number) - (along_m[index - 1] as number);
  const part = span > 0 ? Math.min(1, Math.max(0, (along - (along_m[index - 1] as number)) / span)) : 0;
  const mix = (axis: number): number => Number(a[axis] ?? 0) + part * (Number(b[axis] ?? 0) - Number(a[axis] ?? 0));
  const east = distance_m([Number(a[0]), Number(a[1])], [Number(b[0]), Number(a[1])]) * Math.sign(Number(b[0]) - Number(a[0]));
  const north = distance_m([Number(a[0]), Number(a[1])], [Number(a[0]), Number(b[1])]) * Math.sign(Number(b[1]) - Number(a[1]));
  return { at: [mix(0), mix(1)], altitude_m: a.length > 2 ? mix(2) : null, heading_deg: (Math.atan2(east, north) * 180) / Math.PI };
}

/** What a flight does at a second, in words. */
export function doing(flight: Flight, at_s: number): string {
  const { start_s, end_s, passes, phases } = flight;
  if (at_s < start_s) return "on the ground";
  if (at_s > end_s) return "landed";
  const pass = passes.find((one) => at_s >= one.start_s && at_s <= one.end_s);
  if (pass) return `sees ${pass.roi}`;
  const kind = phases.find((phase) => at_s >= phase.start_s && at_s <= phase.end_s)?.kind ?? "mission";
  if (kind !== "mission") return kind.replace("_", "-");
  const next = passes.filter((one) => one.start_s > at_s).sort((a, b) => a.start_s - b.start_s)[0];
  return next ? `on its way to ${next.roi}` : "on its way home";
}
