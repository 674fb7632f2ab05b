/** Drawing and reshaping with terra-draw: one shape at a time, handed to the scenario when it is done. */
import type { Map as MapLibreMap } from "maplibre-gl";
import { TerraDraw, TerraDrawCircleMode, TerraDrawLineStringMode, TerraDrawPointMode, TerraDrawPolygonMode, TerraDrawSelectMode } from "terra-draw";
import type { GeoJSONStoreFeatures } from "terra-draw";
import type { Geometry, Polygon } from "geojson";
import { within180 } from "./antimeridian";
import { TurnedAdapter } from "./draw_adapter";
import { ahead, boundsOf, circleOf, circleRing, distance_m, labelPoint, round7 } from "./geo";
import { hideWhileEdited, SELECTABLE } from "./layers";
import { warn } from "./notices";
import { nameOf, radiusOf, scenarios } from "./scenario";
import { Signal } from "./signal";
import { drawnWords } from "./size";
import type { Position, Role, ScenarioFeature } from "./types";

export interface Tool {
  id: string;
  label: string;
  role: Role;
  mode: "polygon" | "linestring" | "circle" | "point";
  properties: Record<string, unknown>;
  hint: string;
}

const POLYGON_HINT = "Click the corners; click the first one again, or press Enter, to close. Esc gives up.";
const CIRCLE_HINT = "Click the centre, then click where the circle ends. Esc gives up.";
const LINE_HINT = "Click along the middle of the corridor; click the last point again, or press Enter, to end. Esc gives up.";
const POINT_HINT = "Click the place. Esc gives up.";

export const TOOLS: Tool[] = [
  { id: "roi", label: "Region", role: "roi", mode: "polygon", properties: {}, hint: POLYGON_HINT },
  { id: "corridor", label: "Corridor", role: "roi", mode: "linestring", properties: { width_m: 200 }, hint: LINE_HINT },
  { id: "target", label: "Target", role: "roi", mode: "point", properties: {}, hint: POINT_HINT },
  { id: "missile", label: "Missile", role: "threat", mode: "circle", properties: { model: "missile" }, hint: CIRCLE_HINT },
  { id: "radar", label: "Radar", role: "threat", mode: "circle", properties: { model: "radar" }, hint: CIRCLE_HINT },
  { id: "no_fly", label: "No-fly", role: "no_fly", mode: "polygon", properties: {}, hint: POLYGON_HINT },
  { id: "obstacle", label: "Obstacle", role: "obstacle", mode: "polygon", properties: { height_m: 50 }, hint: POLYGON_HINT },
  { id: "area", label: "Area", role: "area", mode: "polygon", properties: {}, hint: POLYGON_HINT },
  { id: "importance", label: "Importance", role: "importance", mode: "polygon", properties: { score: 1 }, hint: POLYGON_HINT },
  // Somebody is there for sure: the density at its middle is 1/(2π spread²).
  { id: "last_seen", label: "Last seen", role: "importance", mode: "point", properties: { score: 1.768e-6, spread_m: 300 }, hint: POINT_HINT },
  { id: "base", label: "Base", role: "base", mode: "point", properties: {}, hint: POINT_HINT },
  { id: "start", label: "Start", role: "start", mode: "point", properties: {}, hint: POINT_HINT },
  { id: "end", label: "End", role: "end", mode: "point", properties: {}, hint: POINT_HINT },
];

const EDIT_MODE: Record<Tool["mode"], string> = { polygon: "polygon", linestring: "linestring", circle: "circle", point: "point" };
const IDLE = "static";
const SQUARE_SHARE = 0.12;
const HANDLES = 24;
const NEAR_PX = 4;
// How near a click has to be to the first or last corner to end a shape.
const CLOSE_PX = 16;
// Small, so that a small shape can still be taken by its middle.
const GRAB_PX = 11;

/** As the scenario has it: seven digits, longitudes from −180 to 180. */
function rounded(geometry: Geometry): Geometry {
  const place = ([lon, lat]: number[]): number[] => [round7(within180(lon as number)), round7(lat as number)];
  if (geometry.type === "Point") return { type: "Point", coordinates: place(geometry.coordinates) };
  if (geometry.type === "LineString") return { type: "LineString", coordinates: geometry.coordinates.map(place) };
  if (geometry.type !== "Polygon") return geometry;
  return { type: "Polygon", coordinates: geometry.coordinates.map((ring) => ring.map(place)) };
}

/** How terra-draw can edit a feature, where its world is turned to; null for shapes with holes or several parts. */
function editable(feature: ScenarioFeature, turned: TurnedAdapter): GeoJSONStoreFeatures | null {
  const { geometry } = feature;
  const radius_m = radiusOf(feature);
  if (geometry.type === "Point" && radius_m > 0) {
    const ring = circleRing(geometry.coordinates as Position, radius_m, HANDLES);
    return {
      type: "Feature",
      geometry: turned.inside({ type: "Polygon", coordinates: [ring] }),
      properties: { mode: EDIT_MODE.circle, radiusKilometers: radius_m / 1000 },
    };
  }
  if (geometry.type === "Point") {
    return { type: "Feature", geometry: turned.inside(rounded(geometry)) as never, properties: { mode: EDIT_MODE.point } };
  }
  if (geometry.type === "LineString") {
    return { type: "Feature", geometry: turned.inside(rounded(geometry)) as never, properties: { mode: EDIT_MODE.linestring } };
  }
  if (geometry.type === "Polygon" && geometry.coordinates.length === 1) {
    return { type: "Feature", geometry: turned.inside(rounded(geometry)) as never, properties: { mode: EDIT_MODE.polygon } };
  }
  return null;
}

export class Drawing {
  readonly tool = new Signal<Tool | null>(null);
  /** Whether geometry stands fast: no tool, no handles, no key changes it. */
  readonly locked = new Signal<boolean>(true);
  /** How large what is being drawn or dragged is just now, in words. */
  readonly size = new Signal<string>("");
  readonly #map: MapLibreMap;
  readonly #draw: TerraDraw;
  readonly #turned: TurnedAdapter;
  #editing: { name: string; id: string | number } | null = null;
  /** Whether the pointer holds something on the map. */
  #held = false;

  constructor(map: MapLibreMap) {
    this.#map = map;
    let last = 0;
    const whole = { draggable: true, coordinates: { midpoints: true, draggable: true, deletable: true } };
    this.#turned = new TurnedAdapter(map);
    this.#draw = new TerraDraw({
      adapter: this.#turned,
      idStrategy: { isValidId: (id) => typeof id === "number", getId: () => (last += 1) },
      modes: [
        new TerraDrawPolygonMode({ pointerDistance: CLOSE_PX }),
        new TerraDrawLineStringMode({ pointerDistance: CLOSE_PX }),
        new TerraDrawCircleMode({ segments: 64 }),
        new TerraDrawPointMode(),
        new TerraDrawSelectMode({
          pointerDistance: GRAB_PX,
          keyEvents: { deselect: "Escape", delete: null, rotate: null, scale: null },
          flags: {
            polygon: { feature: whole },
            linestring: { feature: whole },
            circle: { feature: { draggable: true, coordinates: { resizable: "center-fixed" } } },
            point: { feature: { draggable: true } },
          },
        }),
      ],
    });
    this.#draw.start();
    this.#draw.setMode(IDLE);
    this.#draw.on("change", (ids, kind) => this.#measure(ids, kind));
    this.#draw.on("finish", (id, context) => {
      this.#say("");
      // The library still works on the feature when it calls; it is taken over after that.
      setTimeout(() => (context.action === "draw" ? this.#take(id) : this.#commit()), 0);
    });
    this.#draw.on("deselect", () => {
      const left = this.#editing?.name;
      // A click on another feature selects that one meanwhile.
      if (left !== undefined) setTimeout(() => this.#deselected(left), 0);
    });
    map.on("click", (event) => this.#click(event.point));
    for (const layer of SELECTABLE) {
      map.on("mouseenter", layer, () => !this.locked.value && this.tool.value === null && (map.getCanvas().style.cursor = "pointer"));
      map.on("mouseleave", layer, () => this.tool.value === null && (map.getCanvas().style.cursor = ""));
    }
    map.getCanvasContainer().addEventListener("pointerdown", () => (this.#held = true));
    addEventListener("pointerup", () => (this.#held = false));
    this.locked.watch((locked) => {
      if (locked) this.#letGo();
    });
    scenarios.selection.watch(() => this.#follow());
    scenarios.document.watch(() => this.#follow());
    addEventListener("keydown", (event) => this.#key(event));
  }

  #say(words: string): void {
    if (words !== this.size.value) this.size.set(words);
  }

  /** Tell the size of what the pointer changes. */
  #measure(ids: (string | number)[], kind: string): void {
    const tool = this.tool.value;
    if (kind === "delete" || (!tool && !this.#held)) return this.#say("");
    for (const id of ids) {
      const changed = this.#draw.hasFeature(id) ? this.#draw.getSnapshotFeature(id) : undefined;
      // Corners and midpoints change with their shape; only the shape has a size.
      if (!changed || changed.geometry.type === "Point" || (tool ? changed.properties["mode"] !== tool.mode : kind !== "update" || id !== this.#editing?.id)) continue;
      const edited = tool ? undefined : scenarios.find(this.#editing?.name ?? null);
      this.#say(drawnWords(this.#turned.outside(changed.geometry as Geometry), tool ? tool.mode === "circle" : edited !== undefined && radiusOf(edited) > 0, tool !== null));
    }
  }

  /** Give up what is being drawn and let go of what is selected; nothing of it changes the scenario. */
  #letGo(): void {
    this.use(null);
    if (scenarios.selection.value !== null) scenarios.selection.set(null);
    this.#map.getCanvas().style.cursor = "";
  }

  /** Begin to draw; null stops. */
  use(tool: Tool | null): void {
    if (tool && this.locked.value) return;
    if (tool) {
      scenarios.selection.set(null);
      this.#turned.turnTo(this.#map.getCenter().lng);
    }
    this.tool.set(tool);
    this.#say("");
    this.#draw.setMode(tool ? tool.mode : IDLE);
  }

  /** Put a first shape into the middle of the view, for those who draw without a pointer. */
  placeAtCentre(tool: Tool): void {
    const view = this.#map.getBounds();
    const middle = this.#map.getCenter();
    const centre: Position = [round7(middle.lng), round7(middle.lat)];
    const half_deg = (view.getNorth() - view.getSouth()) * SQUARE_SHARE;
    const side_m = half_deg * 111_000;
    this.use(null);
    if (tool.mode === "point") {
      scenarios.add(tool.role, rounded({ type: "Point", coordinates: centre }), tool.properties);
    } else if (tool.mode === "circle") {
      this.#addCircle(tool, centre, Math.max(1, Math.round(side_m)));
    } else if (tool.mode === "linestring") {
      const line = [270, 90].map((heading) => ahead(centre, heading, side_m));
      scenarios.add(tool.role, rounded({ type: "LineString", coordinates: line }), tool.properties);
    } else {
      const ring = [225, 135, 45, 315, 225].map((heading) => ahead(centre, heading, side_m * Math.SQRT2));
      scenarios.add(tool.role, rounded({ type: "Polygon", coordinates: [ring] }), tool.properties);
    }
  }

  #addCircle(tool: Tool, centre: Position, radius_m: number): void {
    const extra = tool.properties["model"] === "radar" ? { intensity_m: radius_m } : {};
    scenarios.add(tool.role, rounded({ type: "Point", coordinates: centre }), { ...tool.properties, radius_m, ...extra });
  }

  #take(id: string | number): void {
    const tool = this.tool.value;
    const drawn = this.#draw.getSnapshotFeature(id);
    if (!tool || !drawn || this.locked.value) return;
    const geometry = this.#turned.outside(drawn.geometry as Geometry);
    this.#draw.removeFeatures([id]);
    this.use(null);
    if (tool.mode === "circle") {
      const { centre, radius_m } = circleOf((geometry as Polygon).coordinates[0] ?? []);
      if (radius_m > 0) this.#addCircle(tool, centre, radius_m);
      else warn("The circle has no radius", "Click the centre, then click again where the circle ends.");
    } else {
      scenarios.add(tool.role, rounded(geometry), tool.properties);
    }
  }

  #commit(): void {
    const editing = this.#editing;
    const drawn = editing && this.#draw.getSnapshotFeature(editing.id);
    const feature = editing && scenarios.find(editing.name);
    if (!editing || !drawn || !feature || this.locked.value) return;
    const geometry = this.#turned.outside(drawn.geometry as Geometry);
    if (radiusOf(feature) > 0) {
      const { centre, radius_m } = circleOf((geometry as Polygon).coordinates[0] ?? []);
      scenarios.reshape(editing.name, rounded({ type: "Point", coordinates: centre }), { radius_m });
    } else {
      scenarios.reshape(editing.name, rounded(geometry));
    }
  }

  #deselected(name: string): void {
    if (scenarios.selection.value === name) scenarios.selection.set(null);
  }

  /** Give the selected feature handles; take them from the one before. */
  #follow(): void {
    const name = scenarios.selection.value;
    const feature = this.locked.value ? undefined : scenarios.find(name);
    if (this.#editing && (this.#editing.name !== name || !this.#same(feature))) {
      const { id } = this.#editing;
      this.#editing = null;
      this.#draw.setMode(IDLE);
      if (this.#draw.hasFeature(id)) this.#draw.removeFeatures([id]);
    }
    if (feature && !this.#editing && this.tool.value === null) {
      const [west, , east] = boundsOf([feature]) ?? [0, 0, 0, 0];
      this.#turned.turnTo((west + east) / 2);
      const shape = editable(feature, this.#turned);
      const added = shape ? this.#draw.addFeatures([shape])[0] : undefined;
      if (added?.valid && added.id !== undefined) {
        this.#editing = { name: nameOf(feature), id: added.id };
        this.#draw.setMode("select");
        this.#draw.selectFeature(added.id);
      }
    }
    hideWhileEdited(this.#map, this.#editing?.name ?? null);
  }

  /** Whether the handles already show the feature as the scenario has it. */
  #same(feature: ScenarioFeature | undefined): boolean {
    const drawn = this.#editing && this.#draw.getSnapshotFeature(this.#editing.id);
    if (!feature || !drawn) return false;
    const geometry = this.#turned.outside(drawn.geometry as Geometry);
    if (radiusOf(feature) > 0 && feature.geometry.type === "Point") {
      const { centre, radius_m } = circleOf((geometry as Polygon).coordinates[0] ?? []);
      return radius_m === radiusOf(feature) && JSON.stringify(centre) === JSON.stringify(feature.geometry.coordinates);
    }
    return JSON.stringify(rounded(geometry)) === JSON.stringify(rounded(feature.geometry));
  }

  #click(point: { x: number; y: number }): void {
    if (this.tool.value !== null || this.locked.value) return;
    const box: [[number, number], [number, number]] = [[point.x - NEAR_PX, point.y - NEAR_PX], [point.x + NEAR_PX, point.y + NEAR_PX]];
    const place = this.#map.unproject([point.x, point.y]).toArray() as Position;
    const away = (name: unknown): number => {
      const at = labelPoint(scenarios.find(String(name))?.geometry ?? { type: "Point", coordinates: place });
      return at ? distance_m(place, at) : Infinity;
    };
    // Small things lie over large ones; among equals the nearest in the middle is meant.
    const hits = this.#map
      .queryRenderedFeatures(box, { layers: SELECTABLE })
      .map(({ layer, properties }) => ({ name: properties["fid"] as unknown, rank: SELECTABLE.indexOf(layer.id), away_m: away(properties["fid"]) }))
      .sort((a, b) => a.rank - b.rank || a.away_m - b.away_m);
    const name = hits[0]?.name;
    if (typeof name === "string" && name !== scenarios.selection.value) scenarios.selection.set(name);
  }

  #key(event: KeyboardEvent): void {
    const typing = event.target instanceof HTMLElement && event.target.matches("input, textarea, select");
    if (this.locked.value) return;
    if (event.key === "Escape" && this.tool.value) this.use(null);
    else if (typing) return;
    else if (event.key === "Escape") scenarios.selection.set(null);
    else if (event.key === "Delete" && scenarios.selection.value !== null) scenarios.delete(scenarios.selection.value);
    else if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "z") {
      event.preventDefault();
      if (event.shiftKey) scenarios.redo();
      else scenarios.undo();
    }
  }
}
