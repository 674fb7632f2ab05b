/** One clock for all aircraft of the plan on the map: where each of them is at the second chosen. */
import type { Map as MapLibreMap } from "maplibre-gl";
import { setData } from "../map";
import { open } from "../plans";
import { Signal } from "../signal";
import { onThemeChange } from "../theme";
import { coloursOf, flightsOf, placeAt, type Flight } from "./flights";

/** Seconds after the plan's beginning; null where the clock is not shown. */
export const clock_s = new Signal<number | null>(null);
/** The flights of the plan on the map. */
export const flights = new Signal<Flight[]>([]);

export const isDark = (): boolean => matchMedia("(prefers-color-scheme: dark)").matches;

export function showCrew(map: MapLibreMap, usual: () => string): void {
  let colours = new Map<string, string>();
  const draw = (): void => {
    const at_s = clock_s.value;
    const found = at_s === null ? [] : flights.value;
    setData(
      map,
      "crew",
      found.flatMap((flight) => {
        const place = at_s === null ? null : placeAt(flight, at_s);
        if (!place) return [];
        const properties = { name: flight.vehicle, hovers: flight.type === "multirotor", heading_deg: place.heading_deg - 90, colour: colours.get(flight.vehicle) ?? usual() };
        return [{ type: "Feature" as const, properties, geometry: { type: "Point" as const, coordinates: place.at } }];
      }),
    );
  };
  const recolour = (): void => {
    const shown = open.value;
    colours = shown ? coloursOf(shown.plan, isDark()) : new Map();
    draw();
  };
  let last: string | null = null;
  open.watch((shown) => {
    const id = shown?.record.id ?? null;
    if (id !== last) {
      last = id;
      flights.set(shown ? flightsOf(shown.plan) : []);
      clock_s.set(null);
    }
    recolour();
  });
  clock_s.watch(draw);
  onThemeChange(recolour);
}
