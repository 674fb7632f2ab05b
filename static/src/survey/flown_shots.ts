/** The photos of a flight as they were reported, and the ground each saw from its own attitude. */
import type { Feature, Position as GeoPosition } from "geojson";
import type { PlanCamera, Position } from "../types";
import { degree_m } from "./shots";

const RAD = Math.PI / 180;
/** Farther from straight down than this nothing is drawn, as the judge counts nothing there. */
const FLATTEST = Math.cos(75 * RAD);
/** Turned away by more than this a photo counts for nothing. */
const MOST_TURNED = Math.cos(30 * RAD);

export interface FlownShot {
  number: number;
  at: GeoPosition;
  height_m: number | null;
  /** Corners of its ground, on level ground at the height of home; null where nobody told how the camera was turned. */
  ring: Position[] | null;
}

type Axis = [right: number, forward: number, down: number];

/** The airframe's attitude put upon a vector of its axes: right, forward and down become east, north and down. */
function turned([right, forward, down]: Axis, roll_deg: number, pitch_deg: number, yaw_deg: number): Axis {
  const [roll, pitch, yaw] = [roll_deg * RAD, pitch_deg * RAD, yaw_deg * RAD];
  const y = right * Math.cos(roll) - down * Math.sin(roll);
  const rolled = right * Math.sin(roll) + down * Math.cos(roll);
  const x = forward * Math.cos(pitch) + rolled * Math.sin(pitch);
  const z = rolled * Math.cos(pitch) - forward * Math.sin(pitch);
  return [x * Math.sin(yaw) + y * Math.cos(yaw), x * Math.cos(yaw) - y * Math.sin(yaw), z];
}

interface Attitude {
  roll_deg: number;
  pitch_deg: number;
  yaw_deg: number;
  /** The camera's own, which looks ahead at 0, 0, 0; else the airframe's, on which it looks down, tilted forward. */
  ofCamera: boolean;
}

function ringOf(camera: PlanCamera, at: GeoPosition, height_m: number, { roll_deg, pitch_deg, yaw_deg, ofCamera }: Attitude): Position[] | null {
  if (!ofCamera && Math.cos(roll_deg * RAD) * Math.cos(pitch_deg * RAD) < MOST_TURNED) return null;
  const wide = (camera.columns * camera.pixel_pitch_m) / camera.focal_length_m / 2;
  const high = (camera.rows * camera.pixel_pitch_m) / camera.focal_length_m / 2;
  const [sine, cosine] = [Math.sin(camera.tilt_deg * RAD), Math.cos(camera.tilt_deg * RAD)];
  const metres = degree_m(at[1] as number);
  const corners: Position[] = [];
  for (const [u, v] of [[-wide, -high], [wide, -high], [wide, high], [-wide, high]] as const) {
    const ray: Axis = ofCamera ? [u, 1, -v] : [u, sine + v * cosine, cosine - v * sine];
    const [east, north, down] = turned(ray, roll_deg, pitch_deg, yaw_deg);
    if (down < FLATTEST * Math.hypot(...ray)) return null;
    corners.push([(at[0] as number) + (height_m * east) / down / metres.east, (at[1] as number) + (height_m * north) / down / metres.north]);
  }
  return corners;
}

/** Photos out of a flight's track; their ground where there is one camera, over flat ground. */
export function flownShots(photos: Feature[], camera: PlanCamera | null): FlownShot[] {
  return photos.flatMap(({ geometry, properties }, index): FlownShot[] => {
    if (geometry.type !== "Point") return [];
    const told = (name: string): number | null => (typeof properties?.[name] === "number" ? (properties[name] as number) : null);
    const [height_m, roll, pitch, yaw] = [told("altitude_home_m"), told("roll_deg"), told("pitch_deg"), told("heading_deg")];
    const known = camera && height_m !== null && height_m > 0 && roll !== null && pitch !== null && yaw !== null;
    const ring = known ? ringOf(camera, geometry.coordinates, height_m, { roll_deg: roll, pitch_deg: pitch, yaw_deg: yaw, ofCamera: properties?.["attitude_of"] === "camera" }) : null;
    return [{ number: index + 1, at: geometry.coordinates, height_m, ring }];
  });
}
