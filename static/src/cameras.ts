/** The service's database of cameras, asked for once; and what a camera sees from a height. */
import { connection, get } from "./api";
import { attempt } from "./notices";
import { Signal } from "./signal";
import type { Member } from "./types";

export interface KnownCamera {
  name: string;
  kind: string;
  type: "camera";
  spectrum?: "visible" | "infrared";
  focal_length_m: number;
  pixel_pitch_m: number;
  /** Across and along the flight direction. */
  image_px: [number, number];
  min_interval_s: number;
  source: string;
}

/** A radar by published figures: what an entry of a scenario's sensors may begin with. */
export interface KnownRadar extends Member {
  name: string;
  type: "sar";
  source: string;
}

/** Empty until they were read. */
export const cameras = new Signal<KnownCamera[]>([]);
export const radars = new Signal<KnownRadar[]>([]);

export function keepCameras(): void {
  connection.watch((state) => {
    if (state !== "up" || cameras.value.length > 0) return;
    void attempt("The camera database was not read; cameras can be given by their figures", async () => {
      const found = await get<{ sensors: KnownCamera[]; radars: KnownRadar[] }>("/sensors");
      radars.set(found.radars);
      cameras.set(found.sensors);
    });
  });
}

const plain = (text: string): string => text.toLowerCase().replace(/[^a-z0-9]+/g, " ").trim();

/** Cameras whose name has every word of a text. */
export function like(text: string): KnownCamera[] {
  const words = plain(text).split(" ");
  return cameras.value.filter((camera) => words.every((word) => ` ${plain(camera.name)}`.includes(` ${word}`)));
}

/** The camera of a name, however it is written; the one that is alone in having every word of it. */
export function known(name: unknown): KnownCamera | undefined {
  const text = String(name ?? "");
  const same = cameras.value.find((camera) => plain(camera.name) === plain(text));
  if (same || plain(text) === "") return same;
  const found = like(text);
  return found.length === 1 ? found[0] : undefined;
}

export interface Optics {
  focal_length_m: number;
  pixel_pitch_m: number;
  columns: number;
  rows: number;
}

/** Lens and chip of a scenario's camera; null while they are not known. */
export function opticsOf(sensor: Member | undefined): Optics | null {
  const found: Member | undefined = sensor?.["model"] === undefined ? sensor : (known(sensor["model"]) as Member | undefined);
  const [columns, rows] = Array.isArray(found?.["image_px"]) ? (found["image_px"] as number[]) : [];
  const [focal_length_m, pixel_pitch_m] = [Number(found?.["focal_length_m"]), Number(found?.["pixel_pitch_m"])];
  return focal_length_m > 0 && pixel_pitch_m > 0 && columns && rows ? { focal_length_m, pixel_pitch_m, columns, rows } : null;
}

export interface Seen {
  gsd_m: number;
  across_m: number;
  along_m: number;
  lanes_m: number;
  photos_m: number;
}

/** Straight down, in still air, without margins: what the overlaps make of a height. */
export function seenFrom(optics: Optics, height_m: number, forward: number, side: number): Seen {
  const gsd_m = (optics.pixel_pitch_m / optics.focal_length_m) * height_m;
  const [across_m, along_m] = [optics.columns * gsd_m, optics.rows * gsd_m];
  return { gsd_m, across_m, along_m, lanes_m: (1 - side) * across_m, photos_m: (1 - forward) * along_m };
}

/** The height from which a pixel covers this much straight down. */
export const heightFor_m = (optics: Optics, gsd_m: number): number => (gsd_m * optics.focal_length_m) / optics.pixel_pitch_m;
