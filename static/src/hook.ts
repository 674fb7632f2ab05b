/** What browser tests ask the page: `window.swathplan`. It tells, and looks elsewhere; it changes nothing else. */
import type { Map as MapLibreMap } from "maplibre-gl";
import { track } from "./aircraft";
import { clock_s, flights } from "./crew/clock";
import { placeAt } from "./crew/flights";
import { watched } from "./fleet";
import { flown } from "./flights";
import { keeping } from "./keeping";
import { segments } from "./network";
import { open, running } from "./plans";
import { grids, valueAt, type RasterMember } from "./raster/grid";
import { LAYER_OF } from "./raster/view";
import { scenarios } from "./scenario";
import { found } from "./search/looked_for";
import { looked } from "./search/view";
import { countAt } from "./survey/overlap";
import { overlap, shots, takenShots } from "./survey/view";

export interface Hook {
  /** Features drawn on the screen now, by layer. */
  rendered(): Record<string, number>;
  zoom(): number;
  centre(): [number, number];
  /** Look at another part of the map; resolves once it is drawn. */
  look(lon_deg: number, lat_deg: number, zoom: number): Promise<void>;
  /** The layers drawn at a place in the view. */
  at(lon_deg: number, lat_deg: number): string[];
  /** Place of a longitude and latitude on the map, in pixels from its corner. */
  project(lon_deg: number, lat_deg: number): [number, number];
  scenario(): unknown;
  /** How many scenarios took the place of another. */
  replaced(): number;
  selected(): string | null;
  plan(): { id: string; features: number; waypoints: number } | null;
  planState(): string | null;
  /** Where the scenario is kept: the service's id of it, and whether all is written. */
  kept(): { id: string | null; state: string };
  /** The watched vehicle: where it is, whether it flies, to which item, how many places its live track has and where that begins. */
  vehicle(): { lon_deg: number | null; lat_deg: number | null; armed: boolean; sensor_on: boolean; flight: string | null; item: number | null; track: number; began: [number, number] | null } | null;
  /** Photos of the plan on the map, those a flight took, and how many planned ones see a place: null while that is not counted. */
  photos(): number;
  taken(): number;
  seenBy(lon_deg: number, lat_deg: number): number | null;
  /** Where each aircraft of the plan is at the time chosen. */
  crew(): { vehicle: string; at: [number, number] }[];
  /** What part of what is looked for is found by a second of the plan's clock; null of no search. */
  found(at_s: number): number | null;
  /** The value of the scenario's raster that is drawn at a place. */
  rastered(member: RasterMember, lon_deg: number, lat_deg: number): number | null;
  /** Segments round targets that are drawn, by state. */
  segments(): Record<string, number>;
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
    found: (at_s) => looked.value && found(looked.value, at_s),
    rendered: () => {
      const counts: Record<string, number> = {};
      for (const feature of map.queryRenderedFeatures()) counts[feature.layer.id] = (counts[feature.layer.id] ?? 0) + 1;
      return counts;
    },
    zoom: () => map.getZoom(),
    centre: () => map.getCenter().toArray() as [number, number],
    look: async (lon_deg, lat_deg, zoom) => {
      const drawn = new Promise<void>((resolve) => map.once("idle", () => resolve()));
      map.jumpTo({ center: [lon_deg, lat_deg], zoom });
      map.triggerRepaint();
      await drawn;
    },
    at: (lon_deg, lat_deg) => map.queryRenderedFeatures(map.project([lon_deg, lat_deg])).map(({ layer }) => layer.id),
    project: (lon_deg, lat_deg) => {
      const { x, y } = map.project([lon_deg, lat_deg]);
      return [x, y];
    },
    scenario: () => structuredClone(scenarios.document.value),
    replaced: () => scenarios.replaced.value,
    selected: () => scenarios.selection.value,
    plan: () => (open.value ? { id: open.value.record.id, features: open.value.plan.features.length, waypoints: open.value.items.filter(({ at }) => at !== null).length } : null),
    planState: () => running.value?.state ?? null,
    kept: () => ({ id: keeping.value.id, state: keeping.value.state }),
    vehicle: () => {
      const vehicle = watched.value;
      if (!vehicle) return null;
      const { lon_deg, lat_deg, armed, sensor_on, mission_current } = vehicle.state;
      return { lon_deg, lat_deg, armed, sensor_on: sensor_on === true, flight: vehicle.flight_id, item: mission_current, track: track.points.length, began: track.points[0]?.at ?? null };
    },
    photos: () => shots.value.length,
    taken: () => takenShots.value.length,
    seenBy: (lon_deg, lat_deg) => (overlap.value ? countAt(overlap.value, [lon_deg, lat_deg]) : null),
    crew: () =>
      flights.value.flatMap((flight) => {
        const place = clock_s.value === null ? null : placeAt(flight, clock_s.value);
        return place ? [{ vehicle: flight.vehicle, at: place.at }] : [];
      }),
    rastered: (member, lon_deg, lat_deg) => {
      const grid = grids[member].value;
      return map.getLayer(LAYER_OF[member]) && grid ? valueAt(grid, [lon_deg, lat_deg]) : null;
    },
    segments: () => segments.value,
    flown: () => flown.value?.flight.id ?? null,
  };
}
