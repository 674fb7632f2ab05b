/** The mission as it was read from a vehicle, to be drawn beside the plan. */
import type { Feature } from "geojson";
import { Signal } from "./signal";
import type { HeldItem, Position } from "./types";

/** MAV_CMD: all below steer the aircraft, but for the one that points at a place. */
const FIRST_OF_NO_STEERING = 95;
const NAV_ROI = 80;
const LOITER_TURNS = 18;
const STEP_RAD = Math.PI / 18;

export const held = new Signal<{ vehicle: string; items: HeldItem[] } | null>(null);

/** The line through the places the mission navigates to, round the centres of its turns. */
export function heldFeatures(items: HeldItem[]): Feature[] {
  const flown = items.filter(({ command, lat_deg, lon_deg }) => command < FIRST_OF_NO_STEERING && command !== NAV_ROI && lat_deg !== undefined && lon_deg !== undefined);
  const places = flown.map(({ lon_deg, lat_deg }) => [lon_deg, lat_deg] as Position);
  const coordinates = flown.flatMap(({ command, params }, index): Position[] => {
    const [from, centre, to] = [places[index - 1], places[index]!, places[index + 1]];
    return command === LOITER_TURNS && from && to ? around(from, centre, to, (params?.[2] ?? 0) >= 0) : [centre];
  });
  return coordinates.length > 1 ? [{ type: "Feature", properties: {}, geometry: { type: "LineString", coordinates } }] : [];
}

/** Places from one to another round a centre, both left out. */
function around(from: Position, centre: Position, to: Position, clockwise: boolean): Position[] {
  const east = Math.cos((centre[1] * Math.PI) / 180);
  const polar = ([lon, lat]: Position): [number, number] => [Math.hypot((lon - centre[0]) * east, lat - centre[1]), Math.atan2(lat - centre[1], (lon - centre[0]) * east)];
  const [[radius, first], [, last]] = [polar(from), polar(to)];
  const side = clockwise ? -1 : 1;
  const sweep = (side * (last - first) + 4 * Math.PI) % (2 * Math.PI);
  const pieces = Math.max(1, Math.ceil(sweep / STEP_RAD));
  return Array.from({ length: pieces - 1 }, (_, index): Position => {
    const angle = first + (side * sweep * (index + 1)) / pieces;
    return [centre[0] + (radius * Math.cos(angle)) / east, centre[1] + radius * Math.sin(angle)];
  });
}
