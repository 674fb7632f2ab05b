/** The parts of a flight that a path goes through: where each lies, how long it is and how long it takes. */
import type { Feature, LineString, Position as GeoPosition } from "geojson";
import { unwrapLine } from "./antimeridian";
import { distance_m } from "./geo";
import type { MissionItem } from "./mission";
import type { Phase, PhaseKind, PlanCollection, Position } from "./types";

export const PHASE_WORDS: Record<PhaseKind, string> = { take_off: "Take-off", climb: "Climb", mission: "Mission", return: "Return", landing: "Landing" };

const TAKE_OFFS = new Set([22, 24, 84]);
const LANDINGS = new Set([21, 23, 85]);
const CLIMB = 31;
const RETURN = 20;

export interface PathPhase extends Phase {
  vehicle: string;
}

export function pathsOf(plan: PlanCollection): Feature<LineString>[] {
  return plan.features.filter((feature): feature is Feature<LineString, Record<string, unknown>> => feature.properties["role"] === "path" && feature.geometry.type === "LineString");
}

/** Phases as the plan tells them; none in a plan of the mission alone. */
export function phasesOf(plan: PlanCollection): PathPhase[] {
  return pathsOf(plan).flatMap(({ properties }) => {
    const told = properties?.["phases"];
    return Array.isArray(told) ? (told as Phase[]).map((phase) => ({ ...phase, vehicle: String(properties?.["vehicle"] ?? "") })) : [];
  });
}

/** In three dimensions, as the plan's distances are. */
export function step_m(a: GeoPosition, b: GeoPosition): number {
  return Math.hypot(distance_m(a as Position, b as Position), (b[2] ?? 0) - (a[2] ?? 0));
}

/** The part of a line between two distances along it, which are measured on a line of `length_m`. */
export function part(line: GeoPosition[], start_m: number, end_m: number, length_m: number): GeoPosition[] {
  const whole = unwrapLine(line);
  const at: number[] = [0];
  for (let i = 1; i < whole.length; i += 1) at.push((at[i - 1] as number) + step_m(whole[i - 1] as GeoPosition, whole[i] as GeoPosition));
  const scale = length_m > 0 ? (at.at(-1) as number) / length_m : 1;
  const [from, to] = [start_m * scale, end_m * scale];
  const place = (along: number): GeoPosition => {
    const after = Math.max(1, at.findIndex((value) => value >= along));
    const [a, b] = [whole[after - 1] as Position, whole[after] as Position];
    const span = (at[after] as number) - (at[after - 1] as number);
    const t = span > 0 ? Math.min(1, Math.max(0, (along - (at[after - 1] as number)) / span)) : 0;
    return [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
  };
  if (whole.length < 2 || !(to > from)) return [];
  return [place(from), ...whole.filter((_, i) => (at[i] as number) > from && (at[i] as number) < to), place(Math.min(to, at.at(-1) as number))];
}

const drawn = (kind: PhaseKind, coordinates: GeoPosition[]): Feature => ({
  type: "Feature",
  properties: { role: "phase", kind, label: PHASE_WORDS[kind].toLowerCase() },
  geometry: { type: "LineString", coordinates },
});

/** What lies before and behind the mission itself, for the map; from the mission's items where the plan tells no phases. */
export function phaseFeatures(plan: PlanCollection, items: MissionItem[]): Feature[] {
  const found = pathsOf(plan).flatMap(({ geometry, properties }) => {
    const phases = (properties?.["phases"] as Phase[] | undefined) ?? [];
    const length_m = Math.max(Number(properties?.["length_m"] ?? 0), ...phases.map(({ end_m }) => end_m));
    return phases.filter(({ kind }) => kind !== "mission").map((phase) => drawn(phase.kind, part(geometry.coordinates, phase.start_m, phase.end_m, length_m)));
  });
  const lines = found.length > 0 ? found : ofItems(items);
  return lines.filter(({ geometry }) => geometry.type === "LineString" && geometry.coordinates.length > 1);
}

/** Straight lines between the items that take off, climb, return and land: their order, not their curves. */
function ofItems(items: MissionItem[]): Feature[] {
  const placed = items.filter((item) => item.at !== null);
  const kindOf = ({ command }: MissionItem, index: number): PhaseKind => {
    if (TAKE_OFFS.has(command)) return "take_off";
    if (LANDINGS.has(command)) return "landing";
    if (command === RETURN) return "return";
    return command === CLIMB ? (index < placed.length / 2 ? "climb" : "landing") : "mission";
  };
  return placed.flatMap((item, index) => {
    const before = placed[index - 1];
    const kind = kindOf(item, index);
    // From the circle it climbs in, the aircraft goes over to where the path begins.
    const joins = kind === "mission" && before !== undefined && kindOf(before, index - 1) !== "mission";
    if (item.from === null || (kind === "mission" && !joins)) return [];
    return [drawn(joins ? "climb" : kind, [item.from, item.at as Position])];
  });
}
