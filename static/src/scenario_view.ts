/** From the scenario document to what the map draws of it. */
import type { Feature } from "geojson";
import { circleRing, labelPoint } from "./geo";
import { nameOf, radiusOf } from "./scenario";
import type { Position, Scenario, ScenarioFeature } from "./types";

function kindOf(feature: ScenarioFeature): string {
  const { role } = feature.properties;
  if (role === "threat") return feature.properties["model"] === "radar" ? "radar" : "missile";
  return role === "start" || role === "end" || role === "base" ? "terminal" : role;
}

/** Shapes and, apart from them, one label point a feature; discs become rings. */
export function scenarioFeatures(scenario: Scenario): Feature[] {
  return scenario.features.flatMap((feature) => {
    const properties = { fid: nameOf(feature), kind: kindOf(feature), name: nameOf(feature), label: false };
    const radius_m = radiusOf(feature);
    const shape: Feature = {
      type: "Feature",
      properties,
      geometry:
        radius_m > 0 && feature.geometry.type === "Point"
          ? { type: "Polygon", coordinates: [circleRing(feature.geometry.coordinates as Position, radius_m)] }
          : feature.geometry,
    };
    const at = feature.properties.role === "area" ? null : labelPoint(feature.geometry);
    if (!at) return [shape];
    return [shape, { type: "Feature", properties: { ...properties, label: true }, geometry: { type: "Point", coordinates: at } }];
  });
}
