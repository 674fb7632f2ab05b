/** The mission a plan becomes: its items with number, place, height and distance, as the vehicle counts them. */
import type { Feature } from "geojson";
import { distance_m } from "./geo";
import type { Position } from "./types";

const PX4 = 12;
/** MAV_CMD: all below steer the aircraft, but for those that point at a place. */
const FIRST_OF_NO_STEERING = 95;
const POINTING = new Set([80, 81, 82]);
const RETURN = 20;
const COMMANDS: Record<number, string> = {
  16: "waypoint", 17: "circle, without end", 18: "turns", 19: "circle, for a time", 20: "return to launch", 21: "land",
  22: "take off", 31: "circle to height", 82: "spline", 84: "VTOL take off", 85: "VTOL land", 93: "wait", 112: "wait", 115: "yaw",
  177: "jump", 178: "speed", 181: "sensor (relay)", 183: "sensor (servo)", 187: "sensor (actuator)", 189: "landing begins",
  203: "one photo", 205: "gimbal", 206: "photos", 1000: "gimbal", 2000: "photos begin", 2001: "photos end", 2500: "video begins", 2501: "video ends",
};
const BY_DISTANCE = 206;
const BY_TIME = 2000;
/** MAV_FRAME, both ways to write each. */
const OVER: Record<number, string> = { 0: "above sea", 5: "above sea", 3: "over home", 6: "over home", 10: "over ground", 11: "over ground" };

export interface MissionItem {
  /** As the vehicle counts, and as it is sent to an item. */
  seq: number;
  command: number;
  what: string;
  /** Null where the item has no place. */
  at: Position | null;
  height_m: number | null;
  over: string;
  /** The place before it, home at first, and how far that is. */
  from: Position | null;
  leg_m: number | null;
}

interface QgcItem {
  command?: number;
  doJumpId?: number;
  frame?: number;
  params?: (number | null)[];
}

/** What an item does; of those that take photos, how many and how far apart. */
function whatOf(command: number, params: (number | null)[]): string {
  const [first, second, third] = params.map((value) => value ?? 0);
  if (command === BY_DISTANCE) return first ? `photos every ${first.toFixed(1)} m` : "photos end";
  if (command === BY_TIME) return `${third ? `${third} ` : ""}${third === 1 ? "photo" : "photos"}${second && third !== 1 ? ` every ${second.toFixed(1)} s` : ""}`;
  return COMMANDS[command] ?? `command ${command}`;
}

/** The items of a QGroundControl plan. */
export function itemsOf(document: unknown): MissionItem[] {
  const mission = (document as { mission?: { items?: QgcItem[]; firmwareType?: number; plannedHomePosition?: number[] } } | null)?.mission;
  const first = mission?.firmwareType === PX4 ? 0 : 1;
  const [homeLat, homeLon] = mission?.plannedHomePosition ?? [];
  let before: Position | null = homeLat !== undefined && homeLon !== undefined ? [homeLon, homeLat] : null;
  const home = before;
  return (mission?.items ?? []).map((item, index): MissionItem => {
    const command = item.command ?? 0;
    const [lat, lon, height] = [item.params?.[4], item.params?.[5], item.params?.[6]];
    const steers = command < FIRST_OF_NO_STEERING && !POINTING.has(command);
    const placed = steers && typeof lat === "number" && typeof lon === "number" && (lat !== 0 || lon !== 0);
    const at: Position | null = placed ? [lon, lat] : command === RETURN ? home : null;
    const from = before;
    before = at ?? before;
    return {
      seq: (item.doJumpId ?? index + 1) - 1 + first,
      command,
      what: whatOf(command, item.params ?? []),
      at,
      height_m: placed && typeof height === "number" ? height : null,
      over: OVER[item.frame ?? 0] ?? "",
      from,
      leg_m: at && from ? distance_m(from, at) : null,
    };
  });
}

const heightOf = (item: MissionItem | undefined): string => (item === undefined || item.height_m === null ? "" : `${item.height_m.toFixed(0)} m ${item.over}`);

/** Items with a place, for the map: numbers, and heights where they change; the one being flown is marked. */
export function itemFeatures(items: MissionItem[], current: number | null): Feature[] {
  return items
    .filter((item) => item.at !== null && item.command !== RETURN)
    .map((item, index, placed) => ({
      type: "Feature",
      properties: {
        label: String(item.seq),
        height: heightOf(item) === heightOf(placed[index - 1]) ? "" : heightOf(item),
        current: item.seq === current,
      },
      geometry: { type: "Point", coordinates: item.at as Position },
    }));
}
