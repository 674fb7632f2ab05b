/** The built-in world: land as areas, coasts as lines, both whole across ±180° and round the pole. */
import type { Feature, LineString, MultiPolygon, Polygon, Position } from "geojson";
import { feature } from "topojson-client";
import type { Topology } from "topojson-specification";
import landUrl from "world-atlas/land-10m.json?url";
import { unwrapLine, unwrapRings } from "./antimeridian";

const SOUTH_POLE_DEG = -90;
const HALF_TURN_DEG = 180;
const SAME_DEG = 1e-6;

/** A ring that goes round the world, as Antarctica's does, is closed over the pole behind it. */
function closedOverPole(ring: Position[]): Position[] {
  const [first, last] = [ring[0], ring.at(-1)];
  if (!first || !last || Math.abs(last[0]! - first[0]!) < HALF_TURN_DEG) return ring;
  return [...ring, [last[0]!, SOUTH_POLE_DEG], [first[0]!, SOUTH_POLE_DEG], first];
}

/** Where land was once cut at ±180° its ring still runs along the cut, there and back: that is no coast. */
function onTheCut([lon]: Position): boolean {
  return Math.abs(Math.abs(lon!) % (2 * HALF_TURN_DEG) - HALF_TURN_DEG) < SAME_DEG;
}

/** The pieces of a ring that are coasts. */
function coasts(ring: Position[]): Position[][] {
  const pieces: Position[][] = [];
  let piece: Position[] = [];
  for (const place of unwrapLine(ring)) {
    const before = piece.at(-1);
    if (before && onTheCut(before) && onTheCut(place)) {
      pieces.push(piece);
      piece = [];
    }
    piece.push(place);
  }
  return [...pieces, piece].filter(({ length }) => length > 1);
}

export interface World {
  land: Feature<Polygon>[];
  coast: Feature<LineString>[];
}

/** Areas and coasts of a topology whose rings may cross ±180°; the edges that only close an area are no coast. */
export function worldOf(polygons: Position[][][]): World {
  const land = polygons.map((rings): Feature<Polygon> => {
    const [outer, ...holes] = unwrapRings(rings);
    return { type: "Feature", properties: {}, geometry: { type: "Polygon", coordinates: [closedOverPole(outer ?? []), ...holes] } };
  });
  const coast = polygons.flat().flatMap(coasts).map((coordinates): Feature<LineString> => ({ type: "Feature", properties: {}, geometry: { type: "LineString", coordinates } }));
  return { land, coast };
}

export async function loadWorld(): Promise<World> {
  const answer = await fetch(landUrl);
  if (!answer.ok) throw new Error(`the coastlines answered ${answer.status}`);
  const topology = (await answer.json()) as Topology;
  const land = topology.objects["land"];
  if (!land) throw new Error("the coastlines hold no land");
  const found = feature(topology, land);
  const geometries = found.type === "FeatureCollection" ? found.features.map((each) => each.geometry) : [found.geometry];
  return worldOf(geometries.flatMap((geometry) => (geometry.type === "MultiPolygon" ? (geometry as MultiPolygon).coordinates : geometry.type === "Polygon" ? [geometry.coordinates] : [])));
}
