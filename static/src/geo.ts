/** Geometry on the screen's scale: circles, bounds, distances on a sphere. Nothing here plans. */
import type { Geometry, Position as GeoPosition } from "geojson";
import { nearTo, unwrapLine, unwrapRings } from "./antimeridian";
import type { Position } from "./types";

const EARTH_RADIUS_M = 6371008.8;
const RAD = Math.PI / 180;

export function round7(degrees: number): number {
  return Math.round(degrees * 1e7) / 1e7;
}

/** Great-circle distance. */
export function distance_m(a: Position, b: Position): number {
  const dLat = (b[1] - a[1]) * RAD;
  const dLon = (b[0] - a[0]) * RAD;
  const s = Math.sin(dLat / 2) ** 2 + Math.cos(a[1] * RAD) * Math.cos(b[1] * RAD) * Math.sin(dLon / 2) ** 2;
  return 2 * EARTH_RADIUS_M * Math.asin(Math.min(1, Math.sqrt(s)));
}

/** The place at a distance and a heading (clockwise from north) from another. */
export function ahead(from: Position, heading_deg: number, length_m: number): Position {
  const d = length_m / EARTH_RADIUS_M;
  const lat = from[1] * RAD;
  const t = heading_deg * RAD;
  const lat2 = Math.asin(Math.sin(lat) * Math.cos(d) + Math.cos(lat) * Math.sin(d) * Math.cos(t));
  const dLon = Math.atan2(Math.sin(t) * Math.sin(d) * Math.cos(lat), Math.cos(d) - Math.sin(lat) * Math.sin(lat2));
  return [round7(from[0] + dLon / RAD), round7(lat2 / RAD)];
}

/** Closed ring of a circle on the ground, counter-clockwise. */
export function circleRing(centre: Position, radius_m: number, points = 96): Position[] {
  const ring: Position[] = [];
  for (let i = 0; i < points; i += 1) ring.push(ahead(centre, 360 - (i * 360) / points, radius_m));
  ring.push(ring[0] as Position);
  return ring;
}

/** Closed ring round a line at half a width to either side, with flat ends; corners are mitred up to twice the half. */
export function corridorRing(line: GeoPosition[], width_m: number): Position[] {
  const points = unwrapLine(line).filter((p, i, all) => i === 0 || p[0] !== all[i - 1]?.[0] || p[1] !== all[i - 1]?.[1]) as Position[];
  if (points.length < 2) return [];
  const heading = (a: Position, b: Position): number =>
    Math.atan2((b[0] - a[0]) * Math.cos(((a[1] + b[1]) / 2) * RAD), b[1] - a[1]) / RAD;
  const side = (sign: number): Position[] =>
    points.map((point, i) => {
      const before = i > 0 ? heading(points[i - 1] as Position, point) : heading(point, points[1] as Position);
      const after = i < points.length - 1 ? heading(point, points[i + 1] as Position) : before;
      const half = ((((after - before) % 360) + 540) % 360) / 2 - 90;
      const reach_m = (width_m / 2) * Math.min(2, 1 / Math.max(1e-6, Math.cos(half * RAD)));
      return ahead(point, before + half + sign * 90, reach_m);
    });
  const ring = [...side(1), ...side(-1).reverse()];
  return [...ring, ring[0] as Position];
}

export type Bounds = [number, number, number, number];

function grow(bounds: Bounds, [given, lat]: GeoPosition): void {
  if (given === undefined || lat === undefined || !Number.isFinite(given) || !Number.isFinite(lat)) return;
  // What lies across ±180° is near what is here already, not round the world.
  const lon = Number.isFinite(bounds[0]) ? nearTo(given, (bounds[0] + bounds[2]) / 2) : given;
  bounds[0] = Math.min(bounds[0], lon);
  bounds[1] = Math.min(bounds[1], lat);
  bounds[2] = Math.max(bounds[2], lon);
  bounds[3] = Math.max(bounds[3], lat);
}

/** Every position of a geometry, in order. */
export function positions(geometry: Geometry | null): GeoPosition[] {
  if (!geometry) return [];
  if (geometry.type === "GeometryCollection") return geometry.geometries.flatMap(positions);
  const found: GeoPosition[] = [];
  const walk = (value: unknown): void => {
    if (!Array.isArray(value)) return;
    if (typeof value[0] === "number") found.push(value as GeoPosition);
    else value.forEach(walk);
  };
  walk(geometry.coordinates);
  return found;
}

/** Bounds of geometries (and of discs of `radius_m` round points); null when there is nothing. */
export function boundsOf(items: { geometry: Geometry; radius_m?: number }[]): Bounds | null {
  const bounds: Bounds = [Infinity, Infinity, -Infinity, -Infinity];
  for (const { geometry, radius_m } of items) {
    for (const position of positions(geometry)) {
      grow(bounds, position);
      if (radius_m && radius_m > 0 && Number.isFinite(radius_m)) {
        for (const corner of circleRing(position as Position, radius_m, 8)) grow(bounds, corner);
      }
    }
  }
  return Number.isFinite(bounds[0]) ? bounds : null;
}

/** Centre and radius of a ring drawn as a circle. */
export function circleOf(ring: GeoPosition[]): { centre: Position; radius_m: number } {
  const bounds: Bounds = [Infinity, Infinity, -Infinity, -Infinity];
  for (const position of ring) grow(bounds, position);
  const centre: Position = [round7((bounds[0] + bounds[2]) / 2), round7((bounds[1] + bounds[3]) / 2)];
  const radii = ring.map((position) => distance_m(centre, position as Position));
  const radius_m = radii.reduce((sum, radius) => sum + radius, 0) / Math.max(1, radii.length);
  return { centre, radius_m: Math.round(radius_m) };
}

/** Where to put a name: the mean of the outer ring's corners, or the point, or the middle of a line. */
export function labelPoint(geometry: Geometry): Position | null {
  if (geometry.type === "Point") return geometry.coordinates as Position;
  if (geometry.type === "LineString") return (geometry.coordinates[geometry.coordinates.length >> 1] ?? null) as Position | null;
  const rings = geometry.type === "Polygon" ? geometry.coordinates : geometry.type === "MultiPolygon" ? (geometry.coordinates[0] ?? []) : [];
  const ring = unwrapRings(rings)[0];
  if (!ring || ring.length < 2) return null;
  const corners = ring.slice(0, -1);
  const sum = corners.reduce<[number, number]>((s, c) => [s[0] + (c[0] ?? 0), s[1] + (c[1] ?? 0)], [0, 0]);
  return [sum[0] / corners.length, sum[1] / corners.length];
}

/** Signed distance of a point from a polyline (right of it is positive), on a plane tangent at the point. */
export function offLine_m(point: Position, line: GeoPosition[]): number | null {
  const kx = Math.cos(point[1] * RAD) * EARTH_RADIUS_M * RAD;
  const ky = EARTH_RADIUS_M * RAD;
  let best: number | null = null;
  for (let i = 1; i < line.length; i += 1) {
    const a = line[i - 1] as Position;
    const b = line[i] as Position;
    const ax = (nearTo(a[0], point[0]) - point[0]) * kx;
    const ay = (a[1] - point[1]) * ky;
    const dx = (b[0] - a[0]) * kx;
    const dy = (b[1] - a[1]) * ky;
    const length2 = dx * dx + dy * dy;
    const t = length2 > 0 ? Math.min(1, Math.max(0, -(ax * dx + ay * dy) / length2)) : 0;
    const x = ax + t * dx;
    const y = ay + t * dy;
    const far = Math.hypot(x, y);
    if (best === null || far < Math.abs(best)) best = dx * y - dy * x > 0 ? far : -far;
  }
  return best;
}
