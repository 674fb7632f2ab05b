/** The map itself: an offline base of coastlines and a graticule, an optional raster layer, the controls. */
import { Map as MapLibreMap, NavigationControl, ScaleControl, setWorkerUrl } from "maplibre-gl";
import type { LayerSpecification } from "maplibre-gl";
import workerUrl from "maplibre-gl/dist/maplibre-gl-worker.mjs?worker&url";
import "maplibre-gl/dist/maplibre-gl.css";
import type { FeatureCollection } from "geojson";
import { unwrap } from "./antimeridian";
import { graticule } from "./graticule";
import type { Bounds } from "./geo";
import { report } from "./notices";
import { onThemeChange, palette, type Palette } from "./theme";
import { loadWorld } from "./world";

setWorkerUrl(workerUrl);

export const FONT = ["sans-serif"];
const RASTER_KEY = "swathplan.raster";
const NOTHING: FeatureCollection = { type: "FeatureCollection", features: [] };
const FIT_PADDING_PX = 60;
const LEGEND_PX = 215;
const NARROW_PX = 640;

function baseLayers(colours: Palette): LayerSpecification[] {
  return [
    { id: "water", type: "background", paint: { "background-color": colours.water } },
    { id: "land", type: "fill", source: "land", paint: { "fill-color": colours.land } },
    { id: "coast", type: "line", source: "coast", paint: { "line-color": colours.coast, "line-width": 1 } },
    { id: "grid", type: "line", source: "grid", paint: { "line-color": colours.grid, "line-width": 0.6 } },
    {
      id: "grid-label",
      type: "symbol",
      source: "grid",
      layout: { "text-field": ["get", "label"], "text-font": FONT, "text-size": 10, "symbol-placement": "line", "symbol-spacing": 600 },
      paint: { "text-color": colours.coast, "text-halo-color": colours.halo, "text-halo-width": 1 },
    },
  ];
}

/** Give layers already on the map the colours of the present theme. */
export function repaint(map: MapLibreMap, layers: LayerSpecification[]): void {
  for (const layer of layers) {
    if (!map.getLayer(layer.id) || !("paint" in layer) || !layer.paint) continue;
    for (const [property, value] of Object.entries(layer.paint)) {
      map.setPaintProperty(layer.id, property as never, value as never);
    }
  }
}

function setAsIs(map: MapLibreMap, source: string, features: FeatureCollection["features"]): void {
  const found = map.getSource(source);
  if (found && "setData" in found) (found as { setData(data: FeatureCollection): unknown }).setData({ type: "FeatureCollection", features });
}

/** Show features, each in one piece also where it crosses ±180°. */
export function setData(map: MapLibreMap, source: string, features: FeatureCollection["features"]): void {
  setAsIs(map, source, features.map((feature) => ({ ...feature, geometry: unwrap(feature.geometry) })));
}

export function fit(map: MapLibreMap, bounds: Bounds | null): void {
  if (!bounds) return;
  const right = document.querySelector("#legend details[open]") ? LEGEND_PX : FIT_PADDING_PX;
  const padding = { top: FIT_PADDING_PX, bottom: FIT_PADDING_PX, left: FIT_PADDING_PX, right };
  map.fitBounds(bounds, { padding, maxZoom: 16, duration: 0 });
}

function closeAttribution(container: HTMLElement): void {
  const box = container.querySelector(".maplibregl-ctrl-attrib");
  box?.classList.remove("maplibregl-compact-show");
  box?.removeAttribute("open");
}

async function showWorld(map: MapLibreMap): Promise<void> {
  const { land, coast } = await loadWorld();
  setAsIs(map, "land", land);
  setAsIs(map, "coast", coast);
}

export function rasterTemplate(): string {
  return localStorage.getItem(RASTER_KEY) ?? "";
}

/** Show raster tiles under everything but the base; an empty template takes them away. Off unless asked for. */
export function setRaster(map: MapLibreMap, template: string): void {
  if (template) localStorage.setItem(RASTER_KEY, template);
  else localStorage.removeItem(RASTER_KEY);
  if (map.getLayer("raster")) map.removeLayer("raster");
  if (map.getSource("raster")) map.removeSource("raster");
  if (!template) return;
  map.addSource("raster", { type: "raster", tiles: [template], tileSize: 256 });
  map.addLayer({ id: "raster", type: "raster", source: "raster" }, "grid");
}

/** Make the map; resolves once its style is there. */
export async function createMap(container: HTMLElement): Promise<MapLibreMap> {
  const map = new MapLibreMap({
    container,
    style: {
      version: 8,
      sources: {
        land: { type: "geojson", data: NOTHING, attribution: "Coastlines: Natural Earth, for orientation only" },
        coast: { type: "geojson", data: NOTHING },
        grid: { type: "geojson", data: NOTHING },
      },
      layers: baseLayers(palette()),
    },
    center: [0, 25],
    zoom: 1.4,
    maxPitch: 0,
    dragRotate: false,
    pitchWithRotate: false,
    attributionControl: { compact: true },
  });
  map.touchZoomRotate.disableRotation();
  map.addControl(new NavigationControl({ showCompass: false }), "top-right");
  map.addControl(new ScaleControl({ unit: "metric" }), "bottom-left");
  await new Promise<void>((resolve) => map.once("load", () => resolve()));
  // On a small screen it covers a line of the map: the button opens it.
  if (container.clientWidth < NARROW_PX) closeAttribution(container);
  const drawGrid = (): void => {
    const view = map.getBounds();
    setData(map, "grid", graticule([view.getWest(), view.getSouth(), view.getEast(), view.getNorth()]));
  };
  map.on("moveend", drawGrid);
  drawGrid();
  onThemeChange(() => repaint(map, baseLayers(palette())));
  map.on("error", (event) => report("The map could not draw something", event.error));
  showWorld(map).catch((error: unknown) => report("The coastlines could not be loaded", error));
  try {
    setRaster(map, rasterTemplate());
  } catch (error) {
    report("The raster layer could not be shown", error);
  }
  return map;
}
