/** Elevation rasters that the service holds: which there are, and sending one more. */
import { connection, list, sendFile } from "./api";
import { attempt } from "./notices";
import { Signal } from "./signal";

export interface Raster {
  id: string;
  name: string;
  min_m: number;
  max_m: number;
}

export const rasters = new Signal<Raster[]>([]);

export async function refreshRasters(): Promise<void> {
  rasters.set(await list<Raster>("/terrain", "terrain"));
}

/** List them whenever the service comes up. */
export function keepRasters(): void {
  connection.watch((state) => {
    if (state === "up") void attempt("The elevation rasters were not listed", refreshRasters);
  });
}

/** Send a raster; its record, whose id a scenario names. */
export async function sendRaster(file: File): Promise<Raster> {
  const raster = await sendFile<Raster>(`/terrain?filename=${encodeURIComponent(file.name)}&name=${encodeURIComponent(file.name)}`, file);
  await refreshRasters();
  return raster;
}
