/** From the scenario document to what the map draws of it. */
import type { Feature, Geometry } from "geojson";
import { circleRing, corridorRing, labelPoint } from "./geo";
import { nameOf, radiusOf } from "./scenario";
import type { Position, Scenario, ScenarioFeature } from "./types";

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

/** Shapes and, apart from them, one label point a feature; discs become rings. */
export function scenarioFeatures(scenario: Scenario): Feature[] {
  const most = Math.max(...scenario.features.map(({ properties }) => Number(properties["score"] ?? 0)), 0);
  return scenario.features.flatMap((feature) => {
    const weight = most > 0 ? { weight: Number(feature.properties["score"] ?? 0) / most } : {};
    const properties = { ...weight, fid: nameOf(feature), kind: kindOf(feature), name: nameOf(feature), label: false };
    const radius_m = radiusOf(feature);
    const shape: Feature = { type: "Feature", properties, geometry: outline(feature, radius_m) };
    const at = feature.properties.role === "area" ? null : labelPoint(feature.geometry);
    if (!at) return [shape];
    return [shape, { type: "Feature", properties: { ...properties, label: true }, geometry: { type: "Point", coordinates: at } }];
  });
}
