/** How the scenario, the plan and the flight look on the map: layers, in drawing order, and what toggles them. */
import type { ExpressionSpecification, FilterSpecification, LayerSpecification, Map as MapLibreMap } from "maplibre-gl";
import { FONT, repaint } from "./map";
import { CLASSES } from "./survey/overlap";
import { onThemeChange, palette, type Palette } from "./theme";

export const SOURCES = ["scenario", "plan", "compared", "held", "waypoints", "photos", "taken", "cursor", "crew", "network", "seen", "track"] as const;

export interface Group {
  id: string;
  label: string;
  swatch: string;
  colour: keyof Palette;
  layers: string[];
  /** What it is a part of. */
  of?: "photos";
  /** Whether it is seen only once it is asked for. */
  asked?: true;
  /** What its colours stand for. */
  classes?: readonly { label: string; colour: string }[];
}

/** The legend's entries; each can be hidden. */
export const GROUPS: Group[] = [
  { id: "roi", label: "Region of interest", swatch: "area", colour: "roi", layers: ["roi-fill", "roi-line", "target"] },
  { id: "missile", label: "Missile threat", swatch: "area", colour: "missile", layers: ["missile-fill", "missile-line"] },
  { id: "radar", label: "Radar threat", swatch: "dashed", colour: "radar", layers: ["radar-fill", "radar-line"] },
  { id: "no_fly", label: "No-fly zone", swatch: "area", colour: "noFly", layers: ["no_fly-fill", "no_fly-line"] },
  { id: "obstacle", label: "Obstacle", swatch: "area", colour: "obstacle", layers: ["obstacle-fill", "obstacle-line"] },
  { id: "importance", label: "Importance, the stronger the more", swatch: "area", colour: "importance", layers: ["importance-raster", "importance-fill", "importance-line"] },
  { id: "relief", label: "The ground's relief", swatch: "area", colour: "area", layers: ["relief"] },
  { id: "area", label: "Operating area", swatch: "dashed", colour: "area", layers: ["area-line"] },
  { id: "terminal", label: "Start, end, base", swatch: "dot", colour: "terminal", layers: ["terminal"] },
  { id: "footprint", label: "Ground to be seen", swatch: "area", colour: "footprint", layers: ["footprint-fill", "footprint-line"] },
  { id: "uncovered", label: "Not covered", swatch: "area", colour: "uncovered", layers: ["uncovered-fill", "uncovered-line"] },
  { id: "path", label: "Path", swatch: "line", colour: "path", layers: ["path-line", "path-arrow"] },
  { id: "phases", label: "Take-off, climb, return, landing", swatch: "dashed", colour: "phase", layers: ["phase-line", "phase-label"] },
  { id: "compared", label: "Path compared with", swatch: "line", colour: "area", layers: ["compared-line"] },
  { id: "held", label: "Mission read from the vehicle", swatch: "dashed", colour: "held", layers: ["held-line"] },
  { id: "collect", label: "Collect (sensor on)", swatch: "thick", colour: "collect", layers: ["collect-line", "collect-label"] },
  { id: "network", label: "Segments round targets", swatch: "line", colour: "segment", asked: true, layers: ["network-ruled_out", "network-open", "network-chosen", "network-arrow", "network-end"] },
  { id: "crew", label: "Aircraft at the time chosen", swatch: "dot", colour: "path", layers: ["crew-spot", "crew-symbol"] },
  { id: "photos", of: "photos", label: "Photo, from near", swatch: "dot", colour: "photo", layers: ["photo-place"] },
  { id: "prints", of: "photos", label: "Ground of each photo, from near", swatch: "area", colour: "photo", layers: ["photo-print", "photo-print-one"] },
  { id: "overlap", of: "photos", label: "Photos that see a place", swatch: "none", colour: "photo", layers: ["overlap"], classes: CLASSES },
  { id: "waypoints", label: "Mission items: number, height where it changes", swatch: "dot", colour: "path", layers: ["waypoint", "waypoint-label"] },
  { id: "fence", label: "Fence of a mission file", swatch: "dashed", colour: "noFly", layers: ["fence_out-fill", "fence_out-line", "fence_in-line"] },
  { id: "rally", label: "Rally point", swatch: "dot", colour: "terminal", layers: ["rally"] },
  { id: "taken", label: "Photo taken, its ground from near", swatch: "dot", colour: "trackOn", layers: ["taken-place", "taken-print"] },
  { id: "track", label: "Flown track", swatch: "line", colour: "track", layers: ["track-off"] },
  { id: "trackOn", label: "Flown, sensor on", swatch: "thick", colour: "trackOn", layers: ["track-on"] },
  { id: "remains", label: "Still to be found, at the clock", swatch: "area", colour: "importance", layers: ["remains"] },
  { id: "seen_before", label: "Looked at before this search", swatch: "dashed", colour: "seen", layers: ["seen_before-fill", "seen_before-line"] },
  { id: "seen", label: "Ground really seen", swatch: "area", colour: "seen", layers: ["seen-fill", "seen-line"] },
  { id: "unseen", label: "Not seen in flight", swatch: "area", colour: "uncovered", layers: ["unseen-fill", "unseen-line"] },
  { id: "assumed", label: "Assumed: no photo reported", swatch: "dashed", colour: "seen", layers: ["assumed-line"] },
  { id: "unknown", label: "Not recorded: seen or not", swatch: "dashed", colour: "area", layers: ["unknown-fill", "unknown-line"] },
  { id: "not_counted", label: "Sensor on, not counted", swatch: "dashed", colour: "uncovered", layers: ["not_counted-line"] },
];

const kindIs = (kind: string): FilterSpecification => ["all", ["==", ["get", "kind"], kind], ["!", ["get", "label"]]] as unknown as FilterSpecification;
const kindOf = (kind: string): FilterSpecification => ["==", ["get", "kind"], kind];
/** The ground of the photo of a number. */
export const onePhoto = (number: number): FilterSpecification => ["all", ["==", ["get", "kind"], "print"], ["==", ["get", "number"], number]];
const roleIs = (role: string): FilterSpecification => ["==", ["get", "role"], role];

/** The colour of the aircraft where a plan has several. */
const ofCrew = (usual: string): ExpressionSpecification => ["coalesce", ["get", "colour"], usual];
const segmentIs = (state: string): FilterSpecification => ["all", ["==", ["get", "role"], "segment"], ["==", ["get", "state"], state]];
const fenceIs = (kind: string): FilterSpecification => ["all", ["==", ["get", "role"], "fence"], ["==", ["get", "kind"], kind]];

function shape(id: string, source: string, filter: FilterSpecification, colour: string, opacity: number, width: number, dash?: number[]): LayerSpecification[] {
  const line: LayerSpecification = {
    id: `${id}-line`,
    type: "line",
    source,
    filter,
    paint: { "line-color": colour, "line-width": width, ...(dash ? { "line-dasharray": dash } : {}) },
  };
  if (opacity === 0) return [line];
  return [{ id: `${id}-fill`, type: "fill", source, filter, paint: { "fill-color": colour, "fill-opacity": opacity } }, line];
}

/** Until it is asked for. */
const UNSEEN = { visibility: "none" } as const;

function layers(c: Palette): LayerSpecification[] {
  const label: ExpressionSpecification = [
    "match", ["get", "kind"],
    "missile", c.missile, "radar", c.radar, "no_fly", c.noFly, "obstacle", c.obstacle,
    "area", c.area, "terminal", c.terminal, "importance", c.importance, c.roi,
  ];
  return [
    ...shape("area", "scenario", kindIs("area"), c.area, 0, 1.5, [4, 3]),
    { id: "importance-fill", type: "fill", source: "scenario", filter: kindIs("importance"), paint: { "fill-color": c.importance, "fill-opacity": ["+", ["case", ["==", ["get", "plain"], true], 0, 0.06], ["*", 0.5, ["coalesce", ["get", "weight"], 0.2]]] } },
    ...shape("importance", "scenario", ["all", kindIs("importance"), ["!=", ["get", "plain"], true]] as unknown as FilterSpecification, c.importance, 0, 1, [1, 2]),
    ...shape("seen_before", "scenario", kindIs("seen_before"), c.seen, 0.1, 0.8, [1, 2]),
    ...shape("seen", "seen", roleIs("seen"), c.seen, 0.22, 1.2),
    ...shape("unknown", "seen", roleIs("unknown"), c.area, 0.3, 1.2, [2, 2]),
    ...shape("assumed", "seen", roleIs("assumed"), c.seen, 0, 1.2, [1, 2]),
    ...shape("unseen", "seen", roleIs("unseen"), c.uncovered, 0.35, 1.5),
    // Lanes of a camera overlap by more than half: their ground is told by how many photos see it.
    { id: "footprint-fill", type: "fill", source: "plan", filter: ["all", roleIs("footprint"), ["!=", ["get", "of_photos"], true]] as unknown as FilterSpecification, paint: { "fill-color": c.footprint, "fill-opacity": 0.16 } },
    { id: "footprint-line", type: "line", source: "plan", filter: roleIs("footprint"), paint: { "line-color": c.footprint, "line-width": ["case", ["==", ["get", "of_photos"], true], 0.4, 0.8] } },
    ...shape("roi", "scenario", kindIs("roi"), c.roi, 0.2, 2),
    ...shape("missile", "scenario", kindIs("missile"), c.missile, 0.16, 1.6),
    ...shape("radar", "scenario", kindIs("radar"), c.radar, 0.12, 1.6, [3, 2]),
    ...shape("no_fly", "scenario", kindIs("no_fly"), c.noFly, 0.22, 2.2),
    ...shape("obstacle", "scenario", kindIs("obstacle"), c.obstacle, 0.35, 1.4),
    ...shape("fence_out", "plan", fenceIs("exclusion"), c.noFly, 0.12, 2, [2, 1.5]),
    ...shape("fence_in", "plan", fenceIs("inclusion"), c.area, 0, 2, [2, 1.5]),
    // A search leaves ground unseen by its nature; where all was to be seen it is a fault.
    { id: "uncovered-fill", type: "fill", source: "plan", filter: roleIs("uncovered"), paint: { "fill-color": ["case", ["==", ["get", "searched"], true], c.area, c.uncovered], "fill-opacity": ["case", ["==", ["get", "searched"], true], 0.1, 0.55] } },
    { id: "uncovered-line", type: "line", source: "plan", filter: roleIs("uncovered"), paint: { "line-color": ["case", ["==", ["get", "searched"], true], c.area, c.uncovered], "line-width": 1.5 } },
    {
      id: "compared-line", type: "line", source: "compared",
      layout: { "line-join": "round" },
      paint: { "line-color": c.area, "line-width": 3.5, "line-opacity": 0.55, "line-dasharray": [2, 1.2] },
    },
    {
      id: "held-line", type: "line", source: "held",
      layout: { "line-join": "round" },
      paint: { "line-color": c.held, "line-width": 5, "line-opacity": 0.75, "line-dasharray": [1.2, 0.8] },
    },
    {
      id: "path-line", type: "line", source: "plan", filter: roleIs("path"),
      layout: { "line-join": "round" },
      paint: { "line-color": ofCrew(c.path), "line-width": 1.8, "line-opacity": 0.9 },
    },
    {
      id: "collect-line", type: "line", source: "plan", filter: roleIs("collect"),
      layout: { "line-cap": "round" },
      paint: { "line-color": ofCrew(c.collect), "line-width": 4.5 },
    },
    {
      id: "network-ruled_out", type: "line", source: "network", filter: segmentIs("ruled_out"), layout: UNSEEN,
      paint: { "line-color": c.area, "line-width": 1.2, "line-dasharray": [2, 2], "line-opacity": 0.8 },
    },
    { id: "network-open", type: "line", source: "network", filter: segmentIs("open"), layout: UNSEEN, paint: { "line-color": c.segment, "line-width": 2 } },
    { id: "network-chosen", type: "line", source: "network", filter: segmentIs("chosen"), layout: UNSEEN, paint: { "line-color": c.collect, "line-width": 5 } },
    {
      id: "network-arrow", type: "symbol", source: "network", filter: ["all", roleIs("segment"), ["!=", ["get", "state"], "ruled_out"]] as unknown as FilterSpecification,
      layout: { ...UNSEEN, "symbol-placement": "line-center", "icon-image": "arrow", "icon-size": 0.8 },
      paint: { "icon-color": ["match", ["get", "state"], "chosen", c.collect, c.segment], "icon-halo-color": c.halo, "icon-halo-width": 1 },
    },
    {
      id: "network-end", type: "circle", source: "network", filter: ["all", ["in", ["get", "role"], ["literal", ["ingress", "egress"]]], ["!=", ["get", "state"], "ruled_out"]] as unknown as FilterSpecification,
      layout: UNSEEN,
      paint: {
        "circle-radius": ["match", ["get", "state"], "chosen", 4.5, 2.6],
        "circle-color": ["match", ["get", "role"], "egress", c.halo, ["match", ["get", "state"], "chosen", c.collect, c.segment]],
        "circle-stroke-color": ["match", ["get", "state"], "chosen", c.collect, c.segment], "circle-stroke-width": 1.4,
      },
    },
    { id: "photo-print", type: "line", source: "photos", filter: kindOf("print"), minzoom: 24, paint: { "line-color": c.photo, "line-width": 0.6, "line-opacity": 0.4 } },
    { id: "photo-print-one", type: "line", source: "photos", filter: onePhoto(0), paint: { "line-color": c.photo, "line-width": 3 } },
    {
      id: "photo-place", type: "circle", source: "photos", filter: kindOf("place"), minzoom: 24,
      paint: { "circle-radius": 2.6, "circle-color": c.halo, "circle-stroke-color": c.photo, "circle-stroke-width": 1.4 },
    },
    {
      id: "path-arrow", type: "symbol", source: "plan", filter: roleIs("path"),
      layout: { "symbol-placement": "line", "symbol-spacing": 110, "icon-image": "arrow", "icon-size": 1.05, "icon-allow-overlap": true },
      paint: { "icon-color": ofCrew(c.path), "icon-halo-color": c.halo, "icon-halo-width": 1 },
    },
    {
      id: "phase-line", type: "line", source: "plan", filter: roleIs("phase"),
      layout: { "line-join": "round" },
      paint: { "line-color": c.phase, "line-width": 3, "line-dasharray": [1.6, 1] },
    },
    {
      id: "waypoint", type: "circle", source: "waypoints", minzoom: 11,
      paint: {
        "circle-radius": ["case", ["get", "current"], 6, 2.8],
        "circle-color": ["case", ["get", "current"], c.trackOn, c.halo],
        "circle-stroke-color": c.path, "circle-stroke-width": 1.2,
      },
    },
    {
      id: "rally", type: "circle", source: "plan", filter: roleIs("rally"),
      paint: { "circle-radius": 6, "circle-color": c.halo, "circle-stroke-color": c.terminal, "circle-stroke-width": 3 },
    },
    {
      id: "terminal", type: "circle", source: "scenario", filter: kindIs("terminal"),
      paint: { "circle-radius": 6, "circle-color": c.terminal, "circle-stroke-color": c.halo, "circle-stroke-width": 2 },
    },
    {
      id: "target", type: "circle", source: "scenario",
      filter: kindIs("target"),
      paint: { "circle-radius": 5, "circle-color": c.halo, "circle-stroke-color": c.roi, "circle-stroke-width": 3 },
    },
    {
      id: "track-off", type: "line", source: "track", filter: ["!", ["get", "sensor_on"]],
      layout: { "line-join": "round" },
      paint: { "line-color": c.track, "line-width": 2.6 },
    },
    {
      id: "track-on", type: "line", source: "track", filter: ["get", "sensor_on"],
      layout: { "line-join": "round", "line-cap": "round" },
      paint: { "line-color": c.trackOn, "line-width": 5 },
    },
    { id: "taken-print", type: "line", source: "taken", filter: kindOf("print"), minzoom: 16, paint: { "line-color": c.trackOn, "line-width": 0.6, "line-opacity": 0.5 } },
    {
      id: "taken-place", type: "circle", source: "taken", filter: kindOf("place"), minzoom: 13,
      paint: { "circle-radius": ["interpolate", ["linear"], ["zoom"], 13, 1, 16, 3], "circle-color": c.trackOn, "circle-stroke-color": c.halo, "circle-stroke-width": 0.8 },
    },
    ...shape("not_counted", "seen", roleIs("not_counted"), c.uncovered, 0, 4, [1, 1]),
    {
      id: "collect-label", type: "symbol", source: "plan", filter: roleIs("collect"),
      layout: { "symbol-placement": "line-center", "text-field": ["get", "label"], "text-font": FONT, "text-size": 14, "text-rotation-alignment": "viewport", "text-offset": [0, -1] },
      paint: { "text-color": ofCrew(c.collect), "text-halo-color": c.halo, "text-halo-width": 2 },
    },
    {
      id: "phase-label", type: "symbol", source: "plan", filter: roleIs("phase"), minzoom: 11,
      layout: { "symbol-placement": "line-center", "text-field": ["get", "label"], "text-font": FONT, "text-size": 12, "text-offset": [0, 0.9] },
      paint: { "text-color": c.phase, "text-halo-color": c.halo, "text-halo-width": 1.8 },
    },
    {
      id: "waypoint-label", type: "symbol", source: "waypoints", minzoom: 11.5,
      layout: {
        "text-field": ["step", ["zoom"], ["get", "label"], 13.5, ["case", ["==", ["get", "height"], ""], ["get", "label"], ["concat", ["get", "label"], " · ", ["get", "height"]]]],
        "text-font": FONT, "text-size": 11, "text-max-width": 30, "text-anchor": "top-left", "text-offset": [0.35, 0.2], "symbol-sort-key": ["case", ["get", "current"], 0, ["==", ["get", "height"], ""], 2, 1],
      },
      paint: { "text-color": c.path, "text-halo-color": c.halo, "text-halo-width": 1.6 },
    },
    {
      id: "crew-spot", type: "circle", source: "crew",
      paint: { "circle-radius": ["case", ["get", "hovers"], 9, 12], "circle-color": ["get", "colour"], "circle-opacity": ["case", ["get", "hovers"], 1, 0.25], "circle-stroke-color": c.halo, "circle-stroke-width": 2 },
    },
    {
      id: "crew-symbol", type: "symbol", source: "crew",
      layout: {
        "icon-image": "arrow", "icon-size": ["case", ["get", "hovers"], 1, 1.9], "icon-rotate": ["get", "heading_deg"], "icon-rotation-alignment": "map", "icon-allow-overlap": true,
        "text-field": ["get", "name"], "text-font": FONT, "text-size": 13, "text-offset": [0, 1.3], "text-anchor": "top", "text-optional": true,
      },
      paint: {
        "icon-color": ["case", ["get", "hovers"], c.halo, ["get", "colour"]], "icon-halo-color": c.halo, "icon-halo-width": 1.5,
        "text-color": ["get", "colour"], "text-halo-color": c.halo, "text-halo-width": 2,
      },
    },
    {
      id: "cursor", type: "circle", source: "cursor",
      paint: { "circle-radius": 8, "circle-color": "transparent", "circle-stroke-color": c.trackOn, "circle-stroke-width": 3 },
    },
    {
      id: "scenario-label", type: "symbol", source: "scenario", filter: ["get", "label"],
      layout: { "text-field": ["get", "name"], "text-font": FONT, "text-size": 13, "text-offset": ["match", ["get", "kind"], "terminal", ["literal", [0, -1.1]], "target", ["literal", [0, -1.1]], ["literal", [0, 0]]] },
      paint: { "text-color": label, "text-halo-color": c.halo, "text-halo-width": 1.6 },
    },
  ];
}

/** The layers whose features a click selects. */
export const SELECTABLE = ["terminal", "target", "obstacle-fill", "no_fly-fill", "radar-fill", "missile-fill", "roi-fill", "importance-fill", "area-line"];

const ARROW_PX = 28;

function arrowImage(): ImageData {
  const canvas = new OffscreenCanvas(ARROW_PX, ARROW_PX);
  const context = canvas.getContext("2d");
  if (!context) throw new Error("this browser draws no canvas");
  context.beginPath();
  context.moveTo(ARROW_PX - 4, ARROW_PX / 2);
  context.lineTo(6, 5);
  context.lineTo(11, ARROW_PX / 2);
  context.lineTo(6, ARROW_PX - 5);
  context.closePath();
  context.fill();
  return context.getImageData(0, 0, ARROW_PX, ARROW_PX);
}

export function addLayers(map: MapLibreMap): void {
  map.addImage("arrow", arrowImage(), { sdf: true, pixelRatio: 2 });
  for (const source of SOURCES) {
    map.addSource(source, { type: "geojson", data: { type: "FeatureCollection", features: [] } });
  }
  for (const layer of layers(palette())) map.addLayer(layer);
  onThemeChange(() => repaint(map, layers(palette())));
}

export function showGroup(map: MapLibreMap, group: Group, visible: boolean): void {
  for (const layer of group.layers) if (map.getLayer(layer)) map.setLayoutProperty(layer, "visibility", visible ? "visible" : "none");
}

/** Hide a feature while it is being reshaped by its handles. */
export function hideWhileEdited(map: MapLibreMap, name: string | null): void {
  for (const layer of layers(palette())) {
    if (!("source" in layer) || layer.source !== "scenario" || layer.type === "symbol" || !("filter" in layer)) continue;
    const filter = layer.filter as FilterSpecification;
    map.setFilter(layer.id, name === null ? filter : (["all", filter, ["!=", ["get", "fid"], name]] as unknown as FilterSpecification));
  }
}
