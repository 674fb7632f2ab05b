/** From the scenario document to what the map draws of it. */
import type { Feature, Geometry } from "geojson";
import { ahead, circleRing, corridorRing, labelPoint } from "./geo";
import { nameOf, radiusOf } from "./scenario";
import type { Member, Position, Scenario, ScenarioFeature } from "./types";

/** Discs that stand for a normal distribution: their radii in standard deviations, the widest first. */
const DISCS = [2.5, 2, 1.5, 1, 0.5];

function kindOf(feature: ScenarioFeature): string {
  const { role } = feature.properties;
  if (role === "threat") return feature.properties["model"] === "radar" ? "radar" : "missile";
  if (role === "roi" && feature.geometry.type === "Point" && radiusOf(feature) === 0) return "target";
  return role === "start" || role === "end" || role === "base" ? "terminal" : role;
}

/** What a feature covers: discs become rings, corridors their strips. */
function outline({ geometry, properties }: ScenarioFeature, radius_m: number): Geometry {
  if (geometry.type === "Point" && radius_m > 0) return { type: "Polygon", coordinates: [circleRing(geometry.coordinates as Position, radius_m)] };
  const width_m = Number(properties["width_m"]);
  if (geometry.type === "LineString" && width_m > 0) {
    const ring = corridorRing(geometry.coordinates, width_m);
    if (ring.length > 0) return { type: "Polygon", coordinates: [ring] };
  }
  return geometry;
}

/** Where a point of importance has drifted to by the time the search begins, and how far it may be off. */
function driftedTo(scenario: Scenario, place: Position, spread_m: number): { centre: Position; spread_m: number } {
  const drift = (scenario["search"] as Member | undefined)?.["drift"] as Member | undefined;
  const elapsed_s = Number(drift?.["elapsed_s"] ?? 0);
  const moved_m = Number(drift?.["speed_m_s"] ?? 0) * elapsed_s;
  const centre = moved_m > 0 ? ahead(place, Number(drift?.["toward_deg"] ?? 0), moved_m) : place;
  return { centre, spread_m: Math.hypot(spread_m, Number(drift?.["spread_m_s"] ?? 0) * elapsed_s) };
}

/** Discs, the stronger the more of them lie on each other, and the way drifted until the search begins. */
function spreadOf(scenario: Scenario, { geometry, properties }: ScenarioFeature, shared: Member): Feature[] {
  const spread_m = Number(properties["spread_m"]);
  if (properties.role !== "importance" || geometry.type !== "Point" || !(spread_m > 0)) return [];
  const place = geometry.coordinates as Position;
  const now = driftedTo(scenario, place, spread_m);
  const weight = Number(shared["weight"] ?? 1) / DISCS.length;
  const discs = DISCS.map((part): Feature => ({
    type: "Feature", properties: { ...shared, weight, plain: true },
    geometry: { type: "Polygon", coordinates: [circleRing(now.centre, part * now.spread_m)] },
  }));
  if (now.centre === place) return discs;
  return [...discs, { type: "Feature", properties: shared, geometry: { type: "LineString", coordinates: [place, now.centre] } }];
}

/** Looks that were had before the search, of any aircraft. */
function seenBefore(scenario: Scenario): Feature[] {
  const seen = (scenario["search"] as Member | undefined)?.["seen"];
  return (Array.isArray(seen) ? seen : []).flatMap((entry: unknown): Feature[] => {
    const look = entry as { type?: string; geometry?: Geometry } | null;
    const geometry = look?.type === "Feature" ? look.geometry : (look as Geometry | null);
    if (geometry?.type !== "Polygon" && geometry?.type !== "MultiPolygon") return [];
    return [{ type: "Feature", properties: { fid: "", kind: "seen_before", name: "", label: false }, geometry }];
  });
}

/** Shapes and, apart from them, one label point a feature; discs become rings. */
export function scenarioFeatures(scenario: Scenario): Feature[] {
  const most = Math.max(...scenario.features.map(({ properties }) => Number(properties["score"] ?? 0)), 0);
  const shapes = scenario.features.flatMap((feature): Feature[] => {
    const weight = most > 0 ? { weight: Number(feature.properties["score"] ?? 0) / most } : {};
    const properties = { ...weight, fid: nameOf(feature), kind: kindOf(feature), name: nameOf(feature), label: false };
    const radius_m = radiusOf(feature);
    const shape: Feature = { type: "Feature", properties, geometry: outline(feature, radius_m) };
    const at = feature.properties.role === "area" ? null : labelPoint(feature.geometry);
    if (!at) return [shape];
    return [shape, ...spreadOf(scenario, feature, properties), { type: "Feature", properties: { ...properties, label: true }, geometry: { type: "Point", coordinates: at } }];
  });
  return [...seenBefore(scenario), ...shapes];
}
