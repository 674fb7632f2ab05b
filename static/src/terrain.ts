/** Rasters that the service holds, of heights or of importance: which there are, and sending one more. */
import { connection, list, sendFile } from "./api";
import { attempt } from "./notices";
import { Signal } from "./signal";

export interface Raster {
  id: string;
  name: string;
  min_m: number;
  max_m: number;
  datum: string;
}

/** What a raster's values count from that are no heights. */
const NO_DATUM = "none";
export const isOfHeights = ({ datum }: Raster): boolean => datum !== NO_DATUM;

export const rasters = new Signal<Raster[]>([]);

export async function refreshRasters(): Promise<void> {
  rasters.set(await list<Raster>("/terrain", "terrain"));
}

/** List them whenever the service comes up. */
export function keepRasters(): void {
  connection.watch((state) => {
    if (state === "up") void attempt("The rasters were not listed", refreshRasters);
  });
}

/** Send a raster, of heights or of importance; its record, whose id a scenario names. */
export async function sendRaster(file: File, ofImportance: boolean): Promise<Raster> {
  const name = encodeURIComponent(file.name);
  const raster = await sendFile<Raster>(`/terrain?filename=${name}&name=${name}${ofImportance ? `&vertical_datum=${NO_DATUM}` : ""}`, file);
  await refreshRasters();
  return raster;
}
