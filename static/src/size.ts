/** How large a shape is on WGS 84's ellipsoid, for display: areas of polygons, lengths of lines. */
import type { Geometry, Position as GeoPosition } from "geojson";
import { unwrapLine, unwrapRings } from "./antimeridian";
import { circleOf } from "./geo";
import { metres, squareMetres } from "./units";

const A_M = 6378137;
const E2 = 0.00669437999014;
const E = Math.sqrt(E2);
const RAD = Math.PI / 180;

/** Area between the equator and a latitude over that of a cylinder of the semi-major axis, by Snyder (1987), equation 3-12. */
function share(lat_deg: number): number {
  const s = Math.sin(lat_deg * RAD);
  return ((1 - E2) * (s / (1 - E2 * s * s) - Math.log((1 - E * s) / (1 + E * s)) / (2 * E))) / 2;
}

/** Edges as straight lines of the equal-area cylinder: within 1e-4 of geodesics up to tens of kilometres. */
function ring_m2(ring: GeoPosition[]): number {
  let sum = 0;
  for (let i = 1; i < ring.length; i += 1) {
    const [[lon0, lat0], [lon1, lat1]] = [ring[i - 1], ring[i]] as [[number, number], [number, number]];
    sum += (lon1 - lon0) * RAD * (share(lat0) + share(lat1));
  }
  return (Math.abs(sum) / 2) * A_M ** 2;
}

/** By the radii of curvature in the middle of each edge. */
function line_m(points: GeoPosition[]): number {
  let sum = 0;
  for (let i = 1; i < points.length; i += 1) {
    const [[lon0, lat0], [lon1, lat1]] = [points[i - 1], points[i]] as [[number, number], [number, number]];
    const middle = ((lat0 + lat1) / 2) * RAD;
    const w2 = 1 - E2 * Math.sin(middle) ** 2;
    const north_m = ((A_M * (1 - E2)) / w2 ** 1.5) * (lat1 - lat0) * RAD;
    const east_m = (A_M / Math.sqrt(w2)) * Math.cos(middle) * (lon1 - lon0) * RAD;
    sum += Math.hypot(north_m, east_m);
  }
  return sum;
}

function polygon(rings: GeoPosition[][]): { area_m2: number; round_m: number } {
  const [outer = [], ...holes] = unwrapRings(rings);
  return { area_m2: ring_m2(outer) - holes.reduce((sum, hole) => sum + ring_m2(hole), 0), round_m: line_m(outer) };
}

/** Of what is being drawn or dragged; while a corner is `added`, the side at the pointer too, which is the last one. */
export function drawnWords(geometry: Geometry, round: boolean, added: boolean): string {
  if (geometry.type !== "LineString" && geometry.type !== "Polygon") return "";
  const rings = geometry.type === "Polygon" ? geometry.coordinates : [geometry.coordinates];
  if (round) return `radius ${metres(circleOf(rings[0] ?? []).radius_m)}, ${sizeWords(geometry).split(",")[0] ?? ""}`;
  if (!added) return sizeWords(geometry);
  const corners = geometry.type === "Polygon" ? (rings[0] ?? []).slice(0, -1) : (rings[0] ?? []);
  const path = unwrapLine(corners.filter((corner, i) => i === 0 || corner[0] !== corners[i - 1]?.[0] || corner[1] !== corners[i - 1]?.[1]));
  if (path.length < 2) return "";
  const last = metres(line_m(path.slice(-2)));
  if (path.length === 2) return last;
  return `this side ${last}; ${sizeWords(geometry)}`;
}

/** In words; empty where a shape has no size. */
export function sizeWords(geometry: Geometry): string {
  if (geometry.type === "LineString") return `${metres(line_m(unwrapLine(geometry.coordinates)))} long`;
  if (geometry.type === "Polygon") {
    const { area_m2, round_m } = polygon(geometry.coordinates);
    return `${squareMetres(area_m2)}, ${metres(round_m)} around`;
  }
  if (geometry.type !== "MultiPolygon") return "";
  return squareMetres(geometry.coordinates.reduce((sum, rings) => sum + polygon(rings).area_m2, 0));
}
