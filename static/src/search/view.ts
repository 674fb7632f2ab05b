/** What is still to be found, at the second that the clock of the plan shows. */
import type { CanvasSource, Map as MapLibreMap } from "maplibre-gl";
import { clock_s } from "../crew/clock";
import { open } from "../plans";
import { gridOf, type RasterGrid } from "../raster/grid";
import { Signal } from "../signal";
import { onThemeChange, palette } from "../theme";
import type { Position, Scenario } from "../types";
import { found, left, lookedFor, placeAt_s, toLonLat, type LookedFor, type XY } from "./looked_for";

export const REMAINS_LAYER = "remains";
const SOURCE = "remains";
const UNDER = "roi-fill";
const CELLS = 72;
/** Weak ground is still to be told from none. */
const SHOWN = 0.4;
const BLURS = 2;
const EDGE = BLURS + 1;
/** Of the strongest cell at take-off. */
const STRONGEST = 0.75;

/** Of the search on the map; null where there is none, or nothing here knows what ground is worth. */
export const looked = new Signal<LookedFor | null>(null);

/** How much is found by the clock's second; null where the clock or the search is not shown. */
export const foundByNow = (): number | null => (looked.value && clock_s.value !== null ? found(looked.value, clock_s.value) : null);

interface Grid {
  west: number;
  south: number;
  cell_m: number;
  columns: number;
  rows: number;
}

/** A grid that holds all places from take-off to the end. */
function evenOver({ places, elapsed_s, end_s }: LookedFor): Grid {
  const corners = places.flatMap((place) => [placeAt_s(place, elapsed_s), placeAt_s(place, elapsed_s + end_s)]);
  const [west, south, east, north] = corners.reduce<[number, number, number, number]>(([w, s, e, n], [x, y]) => [Math.min(w, x), Math.min(s, y), Math.max(e, x), Math.max(n, y)], [Infinity, Infinity, -Infinity, -Infinity]);
  const cell_m = Math.max(1, Math.max(east - west, north - south) / CELLS);
  // Cells more on each side, over which what lies at the edge is spread.
  return { west: west - EDGE * cell_m, south: south - EDGE * cell_m, cell_m, columns: Math.ceil((east - west) / cell_m) + 2 * EDGE, rows: Math.ceil((north - south) / cell_m) + 2 * EDGE };
}

/** What is left in each cell, shared among the four whose middles are around a place. Rows from the south. */
function cellsAt(of: LookedFor, { west, south, cell_m, columns, rows }: Grid, at_s: number): Float32Array {
  const cells = new Float32Array(columns * rows);
  for (const place of of.places) {
    const weight = left(of, place, at_s);
    if (weight === 0) continue;
    const [x, y] = placeAt_s(place, of.elapsed_s + Math.min(of.end_s, at_s));
    const [u, v] = [(x - west) / cell_m - 0.5, (y - south) / cell_m - 0.5];
    const [column, row] = [Math.floor(u), Math.floor(v)];
    for (const [i, j] of [[0, 0], [1, 0], [0, 1], [1, 1]] as const) {
      const [c, r] = [column + i, row + j];
      if (c < 0 || c >= columns || r < 0 || r >= rows) continue;
      const share = (i === 0 ? 1 - (u - column) : u - column) * (j === 0 ? 1 - (v - row) : v - row);
      cells[r * columns + c] = (cells[r * columns + c] as number) + weight * share;
    }
  }
  return smooth(cells, { west, south, cell_m, columns, rows });
}

/** Places are samples: over the cells beside it each is told as well as over its own. */
function smooth(cells: Float32Array, { columns, rows }: Grid): Float32Array {
  const along = (from: Float32Array, step: number): Float32Array => from.map((value, i) => 0.5 * value + 0.25 * ((from[i - step] ?? 0) + (from[i + step] ?? 0)));
  let found = cells;
  for (let i = 0; i < BLURS; i += 1) found = along(along(found, 1), columns);
  return found.length === columns * rows ? found : cells;
}

const channels = (colour: string): [number, number, number] => [1, 3, 5].map((from) => parseInt(colour.slice(from, from + 2), 16)) as [number, number, number];

function paint(canvas: HTMLCanvasElement, cells: Float32Array, { columns, rows }: Grid, most: number): void {
  const context = canvas.getContext("2d");
  if (!context) return;
  const picture = context.createImageData(columns, rows);
  const [weak, strong] = [channels(palette().importance), channels(palette().uncovered)];
  for (let row = 0; row < rows; row += 1) {
    for (let column = 0; column < columns; column += 1) {
      const share = most > 0 ? Math.min(1, (cells[row * columns + column] as number) / most) : 0;
      const [red, green, blue] = weak.map((value, i) => value + share * ((strong[i] as number) - value)) as [number, number, number];
      picture.data.set([red, green, blue, Math.round(255 * STRONGEST * share ** SHOWN)], 4 * ((rows - 1 - row) * columns + column));
    }
  }
  context.putImageData(picture, 0, 0);
}

export function showRemains(map: MapLibreMap, visible: () => boolean): void {
  let grid: Grid | null = null;
  let most = 0;
  let canvas: HTMLCanvasElement | null = null;
  const remove = (): void => {
    if (map.getLayer(REMAINS_LAYER)) map.removeLayer(REMAINS_LAYER);
    if (map.getSource(SOURCE)) map.removeSource(SOURCE);
    canvas = null;
  };
  const add = (of: LookedFor, on: Grid): void => {
    canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [on.columns, on.rows];
    const corner = (column: number, row: number): Position => toLonLat(of.frame, [on.west + column * on.cell_m, on.south + row * on.cell_m] as XY);
    const coordinates = [corner(0, on.rows), corner(on.columns, on.rows), corner(on.columns, 0), corner(0, 0)] as [Position, Position, Position, Position];
    map.addSource(SOURCE, { type: "canvas", canvas, coordinates, animate: false });
    map.addLayer({ id: REMAINS_LAYER, type: "raster", source: SOURCE, layout: { visibility: visible() ? "visible" : "none" }, paint: { "raster-resampling": "linear", "raster-fade-duration": 0 } }, UNDER);
  };
  const draw = (): void => {
    const [of, at_s] = [looked.value, clock_s.value];
    // What is told of the ground as drawn would lie over what is left of it.
    map.setPaintProperty("importance-fill", "fill-color", of && at_s !== null ? "transparent" : palette().importance);
    if (!of || at_s === null || !grid) return remove();
    if (!canvas) add(of, grid);
    if (!canvas) return;
    paint(canvas, cellsAt(of, grid, at_s), grid, most);
    const source = map.getSource(SOURCE) as CanvasSource | undefined;
    source?.play();
    map.once("render", () => source?.pause());
    map.triggerRepaint();
  };
  let shown: unknown = null;
  open.watch((plan) => {
    if (plan?.plan === shown) return;
    shown = plan?.plan ?? null;
    remove();
    const scenario = plan && (JSON.parse(plan.madeFrom) as Scenario);
    const show = (raster: RasterGrid | null): void => {
      const of = plan && scenario ? lookedFor(plan.plan, scenario, raster) : null;
      grid = of && evenOver(of);
      most = of && grid ? Math.max(...cellsAt(of, grid, 0)) : 0;
      looked.set(of);
      draw();
    };
    show(null);
    if (scenario?.["importance_raster"] === undefined) return;
    void gridOf(scenario, "importance_raster").then((raster) => {
      if (raster && open.value?.plan === shown) show(raster);
    });
  });
  clock_s.watch(draw);
  onThemeChange(draw);
}
