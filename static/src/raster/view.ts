/** Rasters on the map: importance as heat, the ground as shaded relief. */
import type { Map as MapLibreMap } from "maplibre-gl";
import { clock_s } from "../crew/clock";
import { looked } from "../search/view";
import { mercator } from "../survey/overlap";
import { onThemeChange, palette } from "../theme";
import type { Position } from "../types";
import { grids, type RasterGrid, type RasterMember } from "./grid";

export const LAYER_OF: Record<RasterMember, string> = { importance_raster: "importance-raster", terrain: "relief" };
const RAD = Math.PI / 180;
const METRES_A_DEGREE = 111_195;
/** Weak ground is still to be told from none. */
const SHOWN = 0.5;
const STRONGEST = 0.6;
/** The light comes from the north-west, as on paper maps. */
const LIGHT_TOWARD = [1, -1];
const DARKEST = 0.5;
/** Relief is shown up until its steeper ground has this slope. */
const SEEN_SLOPE = 0.5;
const STEEPER = 0.95;

type Rgba = [red: number, green: number, blue: number, alpha: number];

const channels = (colour: string): [number, number, number] => [1, 3, 5].map((from) => parseInt(colour.slice(from, from + 2), 16)) as [number, number, number];

/** Each cell in the importance's colour, the stronger the more it is worth. */
function heat({ values }: RasterGrid): (cell: number) => Rgba {
  const [red, green, blue] = channels(palette().importance);
  const most = values.reduce<number>((found, value) => Math.max(found, value ?? 0), 0);
  return (cell) => [red, green, blue, most > 0 ? 255 * STRONGEST * (Math.max(0, values[cell] ?? 0) / most) ** SHOWN : 0];
}

/** Light and shade of the ground's slopes; nothing where it is not known. */
function relief({ values, columns, rows, bounds_deg: [west, south, east, north] }: RasterGrid): (cell: number) => Rgba {
  const wide_m = ((east - west) / columns) * METRES_A_DEGREE * Math.cos(((south + north) / 2) * RAD);
  const high_m = ((north - south) / rows) * METRES_A_DEGREE;
  const rise = (cell: number, before: number, after: number, step_m: number): number => {
    const [low, high] = [values[before] ?? values[cell], values[after] ?? values[cell]];
    return low == null || high == null || before === after ? 0 : (high - low) / (step_m * (before === cell || after === cell ? 1 : 2));
  };
  const toLight = values.map((value, cell) => {
    if (value === null) return 0;
    const column = cell % columns;
    const row = (cell - column) / columns;
    const eastward = rise(cell, column > 0 ? cell - 1 : cell, column < columns - 1 ? cell + 1 : cell, wide_m);
    const northward = rise(cell, row < rows - 1 ? cell + columns : cell, row > 0 ? cell - columns : cell, high_m);
    return (eastward * (LIGHT_TOWARD[0] as number) + northward * (LIGHT_TOWARD[1] as number)) / Math.SQRT2;
  });
  const steep = toLight.map(Math.abs).sort((a, b) => a - b)[Math.floor(STEEPER * (toLight.length - 1))] ?? 0;
  const scale = steep > 0 ? Math.max(1, SEEN_SLOPE / steep) : 1;
  return (cell) => {
    const lit = Math.tanh(scale * (toLight[cell] as number));
    const tone = lit > 0 ? 255 : 0;
    return [tone, tone, tone, 255 * DARKEST * Math.abs(lit)];
  };
}

/** A pixel a cell, rows as even on the screen as the map has them. */
function pictureOf({ columns, rows, bounds_deg: [, south, , north] }: RasterGrid, paint: (cell: number) => Rgba): HTMLCanvasElement {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [columns, rows];
  const context = canvas.getContext("2d");
  if (!context) return canvas;
  const image = context.createImageData(columns, rows);
  const [top, bottom] = [mercator(north), mercator(south)];
  for (let row = 0; row < rows; row += 1) {
    const lat = (2 * Math.atan(Math.exp((top - ((row + 0.5) / rows) * (top - bottom)) * RAD)) - Math.PI / 2) / RAD;
    const from = Math.min(rows - 1, Math.max(0, Math.floor(((north - lat) / (north - south)) * rows)));
    for (let column = 0; column < columns; column += 1) image.data.set(paint(from * columns + column).map(Math.round), 4 * (row * columns + column));
  }
  context.putImageData(image, 0, 0);
  return canvas;
}

function draw(map: MapLibreMap, layer: string, under: string, grid: RasterGrid | null, paint: (of: RasterGrid) => (cell: number) => Rgba, visible: boolean): void {
  if (map.getLayer(layer)) map.removeLayer(layer);
  if (map.getSource(layer)) map.removeSource(layer);
  if (!grid) return;
  const [west, south, east, north] = grid.bounds_deg;
  const coordinates = [[west, north], [east, north], [east, south], [west, south]] as [Position, Position, Position, Position];
  map.addSource(layer, { type: "canvas", canvas: pictureOf(grid, paint(grid)), coordinates, animate: false });
  map.addLayer({ id: layer, type: "raster", source: layer, layout: { visibility: visible ? "visible" : "none" }, paint: { "raster-resampling": "linear", "raster-fade-duration": 0 } }, under);
}

/** Draw what the scenario's rasters hold, below its shapes. */
export function showRasters(map: MapLibreMap, isShown: (group: string) => boolean): void {
  const of = (member: RasterMember): RasterGrid | null => grids[member].value;
  // What is told of the ground as it was would lie over what is left of it at the clock.
  const whole = (): boolean => !(looked.value && clock_s.value !== null);
  const drawImportance = (): void => draw(map, LAYER_OF.importance_raster, "importance-fill", of("importance_raster"), heat, isShown("importance") && whole());
  const drawRelief = (): void => draw(map, LAYER_OF.terrain, "area-line", of("terrain"), relief, isShown("relief"));
  grids.importance_raster.watch(drawImportance);
  grids.terrain.watch(drawRelief);
  let before = whole();
  const look = (): void => {
    if (whole() === before) return;
    before = whole();
    drawImportance();
  };
  clock_s.watch(look);
  looked.watch(look);
  onThemeChange(drawImportance);
}
