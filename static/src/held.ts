/** The mission as it was read from a vehicle, to be drawn beside the plan. */
import type { Feature } from "geojson";
import { Signal } from "./signal";
import type { HeldItem, Position } from "./types";

/** MAV_CMD: all below steer the aircraft, but for the one that points at a place. */
const FIRST_OF_NO_STEERING = 95;
const NAV_ROI = 80;

export const held = new Signal<{ vehicle: string; items: HeldItem[] } | null>(null);

/** The line through the places the mission navigates to. */
export function heldFeatures(items: HeldItem[]): Feature[] {
  const flown = ({ command }: HeldItem): boolean => command < FIRST_OF_NO_STEERING && command !== NAV_ROI;
  const coordinates = items.filter(flown).flatMap(({ lon_deg, lat_deg }) => (lon_deg === undefined || lat_deg === undefined ? [] : [[lon_deg, lat_deg] as Position]));
  return coordinates.length > 1 ? [{ type: "Feature", properties: {}, geometry: { type: "LineString", coordinates } }] : [];
}
