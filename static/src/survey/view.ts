/** What of a camera survey is drawn: places of photos, the ground each sees, how often each place is seen. */
import type { Map as MapLibreMap } from "maplibre-gl";
import type { Feature } from "geojson";
import { nearTo } from "../antimeridian";
import { flown } from "../flights";
import { setData } from "../map";
import { open } from "../plans";
import { Signal } from "../signal";
import type { PlanCamera } from "../types";
import { flownShots, type FlownShot } from "./flown_shots";
import { cornersOf, overlapOf, pictureOf, type Overlap } from "./overlap";
import { needProfile, profile } from "./profile";
import { gsd_m, hasPhotos, printOf, shotsOf, type Shot } from "./shots";

/** Photos of the plan on the map, and how often they see each place; null while that is not known. */
export const shots = new Signal<Shot[]>([]);
export const overlap = new Signal<Overlap | null>(null);

export const OVERLAP_LAYER = "overlap";
const OVERLAP_SOURCE = "overlap";
/** Below them on the map. */
/** Over the regions' own fill, whose blue would hide how often their ground is seen. */
const UNDER = "roi-line";
const TILE_PX = 512;
const ROUND_THE_WORLD_M = 40_075_016.686;
/** From these sizes on the screen on they are drawn. */
const PRINT_PX = 90;
const PLACE_PX = 6;
/** So much of the view beside it is drawn as well. */
const BESIDE = 0.5;

/** The zoom from which a length has so many pixels. */
function zoomFor(length_m: number, lat_deg: number, pixels: number): number {
  return Math.max(0, Math.min(22, Math.log2((pixels * ROUND_THE_WORLD_M * Math.cos((lat_deg * Math.PI) / 180)) / (TILE_PX * length_m))));
}

/** Photos whose place is in the view or near it, with the ground of each. */
function features(map: MapLibreMap, all: Shot[], rings: (ReturnType<typeof printOf>)[]): Feature[] {
  const view = map.getBounds();
  const [west, south, east, north] = [view.getWest(), view.getSouth(), view.getEast(), view.getNorth()];
  const [wide, high] = [(east - west) * BESIDE, (north - south) * BESIDE];
  const middle = (west + east) / 2;
  return all.flatMap((shot, index): Feature[] => {
    const [lon, lat] = [nearTo(shot.at[0] as number, middle), shot.at[1] as number];
    if (lon < west - wide || lon > east + wide || lat < south - high || lat > north + high) return [];
    const properties = { number: shot.number, seq: shot.seq, sensor: shot.camera.name, height_m: shot.height_m, gsd_m: shot.height_m === null ? null : gsd_m(shot.camera, shot.height_m) };
    const ring = rings[index];
    return [
      { type: "Feature", properties: { ...properties, kind: "place" }, geometry: { type: "Point", coordinates: shot.at.slice(0, 2) } },
      ...(ring ? [{ type: "Feature" as const, properties: { ...properties, kind: "print" }, geometry: { type: "Polygon" as const, coordinates: [[...ring, ring[0] as [number, number]]] } }] : []),
    ];
  });
}

/** From which zoom on photos are drawn at all. */
function scaleLayers(map: MapLibreMap, all: Shot[], spacing_m: number): number {
  const [shot] = all;
  if (!shot) return Infinity;
  const lat = shot.at[1] as number;
  const { camera, height_m } = shot;
  const wide_m = ((camera.columns * camera.pixel_pitch_m) / camera.focal_length_m) * (height_m ?? 1);
  const [places, prints] = [zoomFor(spacing_m, lat, PLACE_PX), zoomFor(wide_m, lat, PRINT_PX)];
  map.setLayerZoomRange("photo-place", places, 24);
  map.setLayerZoomRange("photo-print", prints, 24);
  return Math.min(places, prints);
}

/** The picture takes the place of the one before it; it lies under regions and lines. */
function drawOverlap(map: MapLibreMap, found: Overlap | null, visible: boolean): void {
  if (map.getLayer(OVERLAP_LAYER)) map.removeLayer(OVERLAP_LAYER);
  if (map.getSource(OVERLAP_SOURCE)) map.removeSource(OVERLAP_SOURCE);
  if (!found) return;
  map.addSource(OVERLAP_SOURCE, { type: "canvas", canvas: pictureOf(found), coordinates: cornersOf(found), animate: false });
  map.addLayer({ id: OVERLAP_LAYER, type: "raster", source: OVERLAP_SOURCE, layout: { visibility: visible ? "visible" : "none" }, paint: { "raster-opacity": 0.75, "raster-resampling": "nearest", "raster-fade-duration": 0 } }, UNDER);
}

/** Photos that were taken, and how often they saw each place; of the flight that is shown. */
export const takenShots = new Signal<FlownShot[]>([]);
export const takenOverlap = new Signal<Overlap | null>(null);

/** The camera of a plan that takes photos; null where there are several, or none. */
function onlyCamera(): PlanCamera | null {
  const photographing = (open.value?.plan.cameras ?? []).filter(({ trigger }) => trigger !== "video");
  return photographing.length === 1 ? (photographing[0] ?? null) : null;
}

function showTaken(map: MapLibreMap, visible: () => boolean): void {
  const draw = (): void => {
    const ofThisPlan = flown.value !== null && flown.value.flight.plan_id === open.value?.record.id;
    // Over a raster nobody here knows the ground below: the service counts, and gives it as a file.
    const camera = ofThisPlan && profile.value?.ground === "flat" ? onlyCamera() : null;
    const all = flownShots(flown.value?.photos ?? [], camera);
    const found = overlapOf(all.flatMap(({ ring }) => (ring ? [ring] : [])));
    setData(
      map,
      "taken",
      all.flatMap(({ number, at, height_m, ring }): Feature[] => [
        { type: "Feature", properties: { kind: "place", number, height_m }, geometry: { type: "Point", coordinates: at.slice(0, 2) } },
        ...(ring ? [{ type: "Feature" as const, properties: { kind: "print", number }, geometry: { type: "Polygon" as const, coordinates: [[...ring, ring[0] as [number, number]]] } }] : []),
      ]),
    );
    takenShots.set(all);
    takenOverlap.set(found);
    drawOverlap(map, found ?? overlap.value, visible());
    if (ofThisPlan && all.length > 0 && profile.value === null) void needProfile();
  };
  flown.watch(draw);
  profile.watch(() => flown.value && draw());
}

/** Draw what belongs to the plan on the map, whenever that or what is known of the ground changes. */
export function showSurvey(map: MapLibreMap, visible: () => boolean): void {
  let drawn: unknown = null;
  let inView = (): void => undefined;
  map.on("moveend", () => inView());
  const draw = (): void => {
    const shown = open.value;
    const key = shown && hasPhotos(shown) ? shown.plan : null;
    const now = key && [key, profile.value];
    if (now === drawn || (Array.isArray(now) && Array.isArray(drawn) && now[0] === drawn[0] && now[1] === drawn[1])) return;
    drawn = now;
    const all = shown && key ? shotsOf(shown, profile.value) : [];
    const rings = all.map(printOf);
    const found = overlapOf(rings.filter((ring) => ring !== null));
    const photos = key?.features.find(({ properties }) => properties["role"] === "photos");
    const from = scaleLayers(map, all, Number(photos?.properties["interval_m"] ?? 1));
    let empty = false;
    // Of tens of thousands only those are handed to the map that can be seen.
    inView = () => {
      const near = map.getZoom() >= from ? features(map, all, rings) : [];
      if (near.length > 0 || !empty) setData(map, "photos", near);
      empty = near.length === 0;
    };
    inView();
    drawOverlap(map, takenOverlap.value ?? found, visible());
    shots.set(all);
    overlap.set(found);
    if (key && profile.value === null) void needProfile();
  };
  open.watch(draw);
  profile.watch(draw);
  showTaken(map, visible);
}
