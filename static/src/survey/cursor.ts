/** A place that is pointed at in a chart, marked on the map. */
import type { Map as MapLibreMap } from "maplibre-gl";
import { setData } from "../map";
import { Signal } from "../signal";
import type { Position } from "../types";

export const cursor = new Signal<Position | null>(null);

export function showCursor(map: MapLibreMap): void {
  cursor.watch((at) => setData(map, "cursor", at ? [{ type: "Feature", properties: {}, geometry: { type: "Point", coordinates: at } }] : []));
}
