/** The service's database of airframes, asked for once; an aircraft that names one flies by its figures. */
import { connection, get } from "./api";
import { attempt } from "./notices";
import { Signal } from "./signal";
import type { Member } from "./types";

export interface Airframe {
  name: string;
  /** What an entry of `vehicles` that names it begins with. */
  vehicle: Member;
  source: string;
}

/** Empty until they were read. */
export const airframes = new Signal<Airframe[]>([]);

export function keepAirframes(): void {
  connection.watch((state) => {
    if (state !== "up" || airframes.value.length > 0) return;
    void attempt("The database of airframes was not read; aircraft can be given by their figures", async () => {
      airframes.set((await get<{ aircraft: Airframe[] }>("/aircraft")).aircraft);
    });
  });
}

/** The airframe of a name, in whatever case it is written. */
export const airframe = (name: unknown): Airframe | undefined => airframes.value.find((known) => known.name.toLowerCase() === String(name ?? "").toLowerCase());

/** An aircraft of the scenario with what it leaves to the airframe it names. */
export const completed = (vehicle: Member): Member => ({ ...airframe(vehicle["model"])?.vehicle, ...vehicle });
