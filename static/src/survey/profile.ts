/** Heights along the plan on the map and of the ground below it, as the service tells them; asked for when needed. */
import { get } from "../api";
import { attempt } from "../notices";
import { open } from "../plans";
import { Signal } from "../signal";

export interface PathProfile {
  vehicle: string;
  sortie: number;
  at_m: number[];
  altitude_m: number[];
  ground_m: (number | null)[];
}

export interface Profile {
  altitude_reference: "amsl" | "home" | "terrain";
  ground: "flat" | "raster" | null;
  paths: PathProfile[];
  photos: { vehicle: string; seq: number; ground_m: (number | null)[] }[];
}

/** Of the plan on the map; null until it was asked for and is there. */
export const profile = new Signal<Profile | null>(null);

let asked: string | null = null;

/** Have it read, once for each plan. */
export async function needProfile(): Promise<void> {
  const id = open.value?.record.id ?? null;
  if (id === null || id === asked) return;
  asked = id;
  const found = await attempt("The heights along the plan were not read", () => get<Profile>(`/plans/${encodeURIComponent(id)}/profile`));
  if (open.value?.record.id !== id) return;
  if (found === null) asked = null;
  profile.set(found);
}

/** A plan's profile leaves with the plan. */
export function keepProfile(): void {
  open.watch((shown) => {
    if ((shown?.record.id ?? null) === asked) return;
    asked = null;
    if (profile.value !== null) profile.set(null);
  });
}
