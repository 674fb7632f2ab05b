/** Values of the rasters that a scenario names, on a coarse grid over what it draws; asked for once for each place. */
import { ApiError, get } from "../api";
import { nearTo } from "../antimeridian";
import { boundsOf, type Bounds } from "../geo";
import { attempt } from "../notices";
import { scenarios } from "../scenario";
import { debounce, Signal } from "../signal";
import type { Position, Scenario } from "../types";

export interface RasterGrid {
  /** West, south, east, north. */
  bounds_deg: Bounds;
  columns: number;
  rows: number;
  /** Row by row from the north-west; rows are even in latitude. */
  values: (number | null)[];
}

export type RasterMember = "terrain" | "importance_raster";

const CELLS = 160;
const NOT_FOUND = 404;
const QUIET_MS = 400;
const MOST_KEPT = 24;
/** Drawn beside the scenario's shapes, of their size. */
const BESIDE = 0.25;
const WORDS: Record<RasterMember, string> = { terrain: "The ground's relief was not drawn", importance_raster: "The importance raster was not drawn" };

const kept = new Map<string, Promise<RasterGrid | null>>();

/** Bounds that a vertex moved by a little does not change: edges on a lattice of their own size. */
function roundOut([west, south, east, north]: Bounds): Bounds {
  const step = 2 ** Math.ceil(Math.log2(Math.max(east - west, north - south, 1e-4) / 8));
  const beside = BESIDE * Math.max(east - west, north - south);
  return [Math.floor((west - beside) / step) * step, Math.max(-90, Math.floor((south - beside) / step) * step), Math.ceil((east + beside) / step) * step, Math.min(90, Math.ceil((north + beside) / step) * step)];
}

/** The grid of a scenario's raster; null where it names none, draws nothing, or the service has none there. */
export async function gridOf(scenario: Scenario, member: RasterMember): Promise<RasterGrid | null> {
  const id = scenario[member];
  const around = boundsOf(scenario.features);
  if (typeof id !== "string" || id === "" || !around) return null;
  const bounds = roundOut(around);
  const key = `${id}|${bounds.join()}`;
  let found = kept.get(key);
  if (!found) {
    // One that the service does not have is among its findings.
    const none = (error: unknown): null => {
      if (error instanceof ApiError && error.status === NOT_FOUND) return null;
      throw error;
    };
    found = attempt(WORDS[member], () => get<RasterGrid>(`/terrain/${encodeURIComponent(id)}/grid?cells=${CELLS}&bounds=${bounds.join()}`).catch(none));
    if (kept.size >= MOST_KEPT) kept.delete(kept.keys().next().value as string);
    kept.set(key, found);
  }
  return found;
}

/** The value of the cell that a place lies in; null outside, and where nothing is known. */
export function valueAt({ bounds_deg: [west, south, east, north], columns, rows, values }: RasterGrid, [lon, lat]: Position): number | null {
  const column = Math.floor(((nearTo(lon, (west + east) / 2) - west) / (east - west)) * columns);
  const row = Math.floor(((north - lat) / (north - south)) * rows);
  return column < 0 || row < 0 || column >= columns || row >= rows ? null : (values[row * columns + column] ?? null);
}

/** Of the scenario on the map; null where there is none. */
export const grids: Record<RasterMember, Signal<RasterGrid | null>> = { terrain: new Signal<RasterGrid | null>(null), importance_raster: new Signal<RasterGrid | null>(null) };

/** Follow the scenario on the map. */
export function keepGrids(): void {
  const look = debounce(() => {
    const scenario = scenarios.document.value;
    for (const member of ["terrain", "importance_raster"] as const) {
      void gridOf(scenario, member).then((found) => {
        if (scenarios.document.value[member] === scenario[member] && grids[member].value !== found) grids[member].set(found);
      });
    }
  }, QUIET_MS);
  scenarios.document.watch(look);
}
