/** How long ago each vehicle told where it is, and how well it is heard: counted on, as long as nothing comes in. */
import type { Vehicle } from "./types";

/** From here on a position is old news, and from there on it says nothing of where the aircraft is. */
export const OLD_S = 3;
export const STALE_S = 10;
const WEAK = 0.7;

interface Heard {
  /** Page time of the answer it stands in, and its age then. */
  at_ms: number;
  age_s: number;
  time_s: number | null;
  /** Page time at which its own clock last moved. */
  moved_ms: number;
  lost_ms: number | null;
}

const heard = new Map<string, Heard>();

const lostNow = ({ connected, link, system_id }: Vehicle): boolean => system_id !== null && (link?.lost ?? !connected);

/** Take note of a vehicle's record as it comes in. */
export function hear(vehicle: Vehicle, now_ms = performance.now()): void {
  const before = heard.get(vehicle.id);
  const { time_s } = vehicle.state;
  const moved_ms = before && before.time_s === time_s ? before.moved_ms : now_ms;
  const told = vehicle.position_age_s;
  const since = vehicle.link?.lost_since ? now_ms - Math.max(0, Date.now() - Date.parse(vehicle.link.lost_since)) : null;
  const lost_ms = lostNow(vehicle) ? (since ?? before?.lost_ms ?? moved_ms) : null;
  heard.set(vehicle.id, { at_ms: now_ms, age_s: told ?? (now_ms - moved_ms) / 1000, time_s, moved_ms, lost_ms });
}

export interface Hearing {
  /** Heard before, and not any more. */
  lost: boolean;
  lost_s: number | null;
  /** Age of the position; null where none was ever told. */
  age_s: number | null;
  quality: number | null;
  tone: "good" | "warning" | "error" | "quiet";
  words: string;
}

const whole = (seconds: number): string => (seconds < 90 ? `${Math.floor(seconds)} s` : `${Math.floor(seconds / 60)} min`);

/** How a vehicle is heard at this moment. */
export function hearing(vehicle: Vehicle, now_ms = performance.now()): Hearing {
  const known = heard.get(vehicle.id);
  const placed = vehicle.state.lon_deg !== null && vehicle.state.lat_deg !== null;
  const age_s = known && placed ? known.age_s + (now_ms - known.at_ms) / 1000 : null;
  const quality = vehicle.link?.quality ?? null;
  const lost = lostNow(vehicle);
  const lost_s = lost && known?.lost_ms != null ? (now_ms - known.lost_ms) / 1000 : null;
  const share = quality === null ? "" : ` ${Math.round(quality * 100)} %`;
  const common = { lost, lost_s, age_s, quality };
  if (lost) return { ...common, tone: "error", words: `LOST${lost_s === null ? "" : ` ${whole(lost_s)}`}` };
  if (vehicle.system_id === null || !vehicle.connected) return { ...common, tone: "quiet", words: vehicle.other_system !== null ? "another aircraft" : "not heard yet" };
  if (age_s !== null && age_s > STALE_S) return { ...common, tone: "error", words: `silent${share}` };
  if ((age_s !== null && age_s > OLD_S) || (quality !== null && quality < WEAK)) return { ...common, tone: "warning", words: `weak${share}` };
  return { ...common, tone: "good", words: `good${share}` };
}

export function ageWords({ age_s }: Hearing): string {
  return age_s === null ? "no position" : age_s < OLD_S ? `${age_s.toFixed(1)} s` : whole(age_s);
}
