/** What lies under the pointer: a segment round a target, a photo's figures, or how many photos see the place. */
import type { Map as MapLibreMap } from "maplibre-gl";
import { byId } from "../dom";
import { onePhoto } from "../layers";
import { isShown } from "../legend";
import { segmentAt } from "../network";
import type { Position } from "../types";
import { number } from "../units";
import { countAt } from "./overlap";
import { overlap, shots, takenOverlap, takenShots } from "./view";

const NEAR_PX = 6;

/** A length on the ground as photographers tell it. */
export function groundWords(gsd_m: number): string {
  return gsd_m < 0.995 ? `${(gsd_m * 100).toFixed(gsd_m < 0.1 ? 2 : 1)} cm` : number(gsd_m, 2, "m");
}

function photoWords(properties: Record<string, unknown>): string {
  const { height_m, gsd_m } = properties as { height_m: number | null; gsd_m: number | null };
  const height = height_m === null ? "" : ` · ${height_m.toFixed(0)} m over the ground · ${groundWords(gsd_m as number)} a pixel`;
  return `Photo ${String(properties["number"])} of ${shots.value.length}, pass ${String(properties["seq"])}, ${String(properties["sensor"])}${height}`;
}

export function showReadout(map: MapLibreMap): void {
  const box = byId("readout");
  const say = (words: string): void => {
    box.hidden = words === "";
    if (box.textContent !== words) box.textContent = words;
  };
  let outlined = 0;
  const outline = (number: number): void => {
    if (number === outlined) return;
    outlined = number;
    map.setFilter("photo-print-one", onePhoto(number));
  };
  const tell = (point: { x: number; y: number }): void => {
    const around: [[number, number], [number, number]] = [[point.x - NEAR_PX, point.y - NEAR_PX], [point.x + NEAR_PX, point.y + NEAR_PX]];
    const segment = segmentAt(map, around);
    if (segment || (shots.value.length === 0 && takenShots.value.length === 0)) return say(segment);
    const photo = map.queryRenderedFeatures(around, { layers: ["photo-place"] })[0];
    outline(Number(photo?.properties["number"] ?? 0));
    if (photo) return say(photoWords(photo.properties));
    if (!isShown("overlap")) return say("");
    const place = map.unproject([point.x, point.y]).toArray() as Position;
    const planned = overlap.value ? countAt(overlap.value, place) : 0;
    if (takenOverlap.value === null) return say(planned === 0 ? "" : `${planned} ${planned === 1 ? "photo sees" : "photos see"} this place`);
    const taken = countAt(takenOverlap.value, place);
    say(planned === 0 && taken === 0 ? "" : `${taken} ${taken === 1 ? "photo" : "photos"} taken of this place, ${planned} planned`);
  };
  let waiting = false;
  map.on("mousemove", ({ point }) => {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      tell(point);
    });
  });
  map.on("click", ({ point }) => tell(point));
  map.on("mouseout", () => say(""));
  overlap.watch((found) => found === null && say(""));
}
