/** What browser tests ask the page: `window.swathplan`. It only tells; it changes nothing. */
import type { Map as MapLibreMap } from "maplibre-gl";
import { track } from "./aircraft";
import { watched } from "./fleet";
import { flown } from "./flights";
import { open, running } from "./plans";
import { scenarios } from "./scenario";

export interface Hook {
  /** Features drawn on the screen now, by layer. */
  rendered(): Record<string, number>;
  zoom(): number;
  centre(): [number, number];
  /** Place of a longitude and latitude on the map, in pixels from its corner. */
  project(lon_deg: number, lat_deg: number): [number, number];
  scenario(): unknown;
  selected(): string | null;
  plan(): { id: string; features: number; waypoints: number } | null;
  planState(): string | null;
  /** The watched vehicle: where it is, whether it flies, how many places its live track has. */
  vehicle(): { lon_deg: number | null; lat_deg: number | null; armed: boolean; sensor_on: boolean; flight: string | null; track: number } | null;
  /** The flight whose seen ground is on the map. */
  flown(): string | null;
}

declare global {
  interface Window {
    swathplan?: Hook;
  }
}

export function installHook(map: MapLibreMap): void {
  window.swathplan = {
    rendered: () => {
      const counts: Record<string, number> = {};
      for (const feature of map.queryRenderedFeatures()) counts[feature.layer.id] = (counts[feature.layer.id] ?? 0) + 1;
      return counts;
    },
    zoom: () => map.getZoom(),
    centre: () => map.getCenter().toArray() as [number, number],
    project: (lon_deg, lat_deg) => {
      const { x, y } = map.project([lon_deg, lat_deg]);
      return [x, y];
    },
    scenario: () => structuredClone(scenarios.document.value),
    selected: () => scenarios.selection.value,
    plan: () => (open.value ? { id: open.value.record.id, features: open.value.plan.features.length, waypoints: open.value.waypoints.length } : null),
    planState: () => running.value?.state ?? null,
    vehicle: () => {
      const vehicle = watched.value;
      if (!vehicle) return null;
      const { lon_deg, lat_deg, armed, sensor_on } = vehicle.state;
      return { lon_deg, lat_deg, armed, sensor_on: sensor_on === true, flight: vehicle.flight_id, track: track.points.length };
    },
    flown: () => flown.value?.flight.id ?? null,
  };
}
