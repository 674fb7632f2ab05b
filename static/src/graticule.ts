/** Lines of longitude and latitude over the view, at a round spacing. */
import type { Feature, LineString } from "geojson";
import { within180 } from "./antimeridian";
import type { Bounds } from "./geo";

const STEPS_DEG = [30, 15, 10, 5, 2, 1, 30 / 60, 15 / 60, 10 / 60, 5 / 60, 2 / 60, 1 / 60, 30 / 3600, 15 / 3600, 5 / 3600, 1 / 3600];
const LINES_WANTED = 5;
const MERCATOR_LIMIT_DEG = 85;
const HALF_TURN_S = 180 * 3600;

/** Degrees, minutes and seconds, as far as they are not nought; neither hemisphere has the half turn. */
export function angleText(value_deg: number, positive: string, negative: string): string {
  const total_s = Math.round(Math.abs(value_deg) * 3600);
  const minutes = Math.floor((total_s % 3600) / 60);
  const rest_s = total_s % 60;
  let text = `${Math.floor(total_s / 3600)}°`;
  if (minutes || rest_s) text += `${String(minutes).padStart(2, "0")}′`;
  if (rest_s) text += `${String(rest_s).padStart(2, "0")}″`;
  return total_s === 0 || total_s === HALF_TURN_S ? text : text + (value_deg > 0 ? positive : negative);
}

function multiples(from: number, to: number, step: number): number[] {
  const found: number[] = [];
  for (let i = Math.ceil(from / step); i <= Math.floor(to / step); i += 1) found.push(i * step);
  return found;
}

export function graticule([west, south, east, north]: Bounds): Feature<LineString>[] {
  const span = Math.min(east - west, 360);
  const step = STEPS_DEG.find((candidate) => span / candidate >= LINES_WANTED) ?? (STEPS_DEG.at(-1) as number);
  const low = Math.max(south - step, -MERCATOR_LIMIT_DEG);
  const high = Math.min(north + step, MERCATOR_LIMIT_DEG);
  const line = (coordinates: [number, number][], label: string): Feature<LineString> => ({
    type: "Feature",
    properties: { label },
    geometry: { type: "LineString", coordinates },
  });
  return [
    ...multiples(west - step, east + step, step).map((lon) => line([[lon, low], [lon, high]], angleText(within180(lon), "E", "W"))),
    ...multiples(low, high, step).map((lat) => line([[west - step, lat], [east + step, lat]], angleText(lat, "N", "S"))),
  ];
}
