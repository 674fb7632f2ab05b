/** The photos of a plan: where each is taken, how the camera is turned there, and the ground it sees. */
import type { Position as GeoPosition } from "geojson";
import type { OpenPlan } from "../plans";
import type { PlanCamera, Position, Scenario } from "../types";
import type { Profile } from "./profile";

const RAD = Math.PI / 180;
/** WGS 84. */
const EQUATOR_M = 6378137;
const FLATTENING_2 = 0.00669437999014;

export interface Shot {
  /** From 1, over all photos of the plan in the order of its collects. */
  number: number;
  seq: number;
  camera: PlanCamera;
  at: GeoPosition;
  /** Over the ground below; null where that is not known. */
  height_m: number | null;
  /** Where the top of the image points, clockwise from north. */
  nose_deg: number;
}

export interface Vector {
  east: number;
  north: number;
}

/** Metres of a degree of longitude and of latitude. */
export function degree_m(lat_deg: number): Vector {
  const sine2 = Math.sin(lat_deg * RAD) ** 2;
  const across = EQUATOR_M / Math.sqrt(1 - FLATTENING_2 * sine2);
  return { east: across * Math.cos(lat_deg * RAD) * RAD, north: ((across * (1 - FLATTENING_2)) / (1 - FLATTENING_2 * sine2)) * RAD };
}

/** Where an aircraft's nose points on a course: into the wind by as much as keeps it on its line. */
export function nose_deg(course_deg: number, airspeed_m_s: number, wind_m_s: number, from_deg: number): number {
  const course: Vector = { east: Math.sin(course_deg * RAD), north: Math.cos(course_deg * RAD) };
  const wind: Vector = { east: -wind_m_s * Math.sin(from_deg * RAD), north: -wind_m_s * Math.cos(from_deg * RAD) };
  const tail_m_s = course.east * wind.east + course.north * wind.north;
  const ground_m_s = tail_m_s + Math.sqrt(Math.max(0, tail_m_s ** 2 + airspeed_m_s ** 2 - wind_m_s ** 2));
  return Math.atan2(ground_m_s * course.east - wind.east, ground_m_s * course.north - wind.north) / RAD;
}

/** Whether the camera turns with the nose: not under what hovers, nor where the scenario has it steered. */
function turnsWithNose({ plan, madeFrom }: OpenPlan, vehicle: string, sensor: string): { airspeed_m_s: number } | null {
  const aircraft = plan.vehicles?.find(({ name }) => name === vehicle);
  const asked = (JSON.parse(madeFrom) as Scenario).sensors?.find(({ name }) => name === sensor);
  if (!aircraft || aircraft.type === "multirotor" || asked?.["stabilised"] === true || !plan.wind?.speed_m_s) return null;
  return { airspeed_m_s: aircraft.airspeed_m_s };
}

export const hasPhotos = (shown: OpenPlan | null): boolean => shown?.plan.features.some(({ properties }) => properties["role"] === "photos") ?? false;

/** All photos of a plan; without a profile their heights over ground are not known. */
export function shotsOf(shown: OpenPlan, profile: Profile | null): Shot[] {
  const { plan } = shown;
  const shots: Shot[] = [];
  for (const { properties, geometry } of plan.features) {
    if (properties["role"] !== "photos" || geometry.type !== "MultiPoint") continue;
    const { vehicle, seq, sensor } = properties as { vehicle: string; seq: number; sensor: string };
    const camera = plan.cameras?.find(({ name }) => name === sensor);
    const collect = plan.features.find((other) => other.properties["role"] === "collect" && other.properties["vehicle"] === vehicle && other.properties["seq"] === seq);
    if (!camera || !collect) continue;
    const course_deg = Number(collect.properties["heading_deg"]);
    const crabbing = turnsWithNose(shown, vehicle, sensor);
    const nose = crabbing ? nose_deg(course_deg, crabbing.airspeed_m_s, plan.wind?.speed_m_s ?? 0, plan.wind?.from_deg ?? 0) : course_deg;
    const ground = profile?.photos.find((other) => other.vehicle === vehicle && other.seq === seq)?.ground_m;
    geometry.coordinates.forEach((at, index) => {
      const below_m = ground?.[index];
      const height_m = typeof below_m === "number" && at[2] !== undefined ? at[2] - below_m : null;
      shots.push({ number: shots.length + 1, seq, camera, at, height_m, nose_deg: nose });
    });
  }
  return shots;
}

/** What a pixel in the middle of the image covers: the mean of along and across the line of sight. */
export function gsd_m(camera: PlanCamera, height_m: number): number {
  const down = Math.cos(camera.tilt_deg * RAD);
  return ((camera.pixel_pitch_m / camera.focal_length_m) * height_m * (1 / down + 1 / down ** 2)) / 2;
}

/** Corners of the ground that a photo sees, on level ground at the height below it; null where none is known. */
export function printOf({ camera, at, height_m, nose_deg: nose }: Shot): Position[] | null {
  if (height_m === null || height_m <= 0) return null;
  const wide = (camera.columns * camera.pixel_pitch_m) / camera.focal_length_m / 2;
  const high = (camera.rows * camera.pixel_pitch_m) / camera.focal_length_m / 2;
  const [sine, cosine] = [Math.sin(camera.tilt_deg * RAD), Math.cos(camera.tilt_deg * RAD)];
  const [lon, lat] = at as Position;
  const metres = degree_m(lat);
  const [noseSine, noseCosine] = [Math.sin(nose * RAD), Math.cos(nose * RAD)];
  const corners: Position[] = [];
  for (const [u, v] of [[-wide, -high], [wide, -high], [wide, high], [-wide, high]] as const) {
    const down = cosine - v * sine;
    if (down <= 0) return null;
    const ahead_m = (height_m * (sine + v * cosine)) / down;
    const right_m = (height_m * u) / down;
    corners.push([lon + (ahead_m * noseSine + right_m * noseCosine) / metres.east, lat + (ahead_m * noseCosine - right_m * noseSine) / metres.north]);
  }
  return corners;
}
