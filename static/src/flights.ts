/** What was flown: the list of flights, and the ground really seen by one of them. */
import type { Feature, FeatureCollection, LineString } from "geojson";
import { apiUrl, get, list, post, sendFile } from "./api";
import { watched } from "./fleet";
import { attempt, news } from "./notices";
import { open } from "./plans";
import { scenarios } from "./scenario";
import { Signal } from "./signal";
import type { TrackPoint } from "./track";
import type { Flight, PlanRecord, Position, SeenCollection } from "./types";

export interface Flown {
  flight: Flight;
  seen: SeenCollection;
  track: Feature<LineString>[];
  /** As the camera reported them. */
  photos: Feature[];
}

export const flights = new Signal<Flight[]>([]);
export const flown = new Signal<Flown | null>(null);

export async function refreshFlights(): Promise<void> {
  flights.set(await list<Flight>("/flights", "flights"));
}

/** Bring what a flight saw, and where it went, onto the map. */
export async function showFlight(flight: Flight): Promise<void> {
  const path = `/flights/${encodeURIComponent(flight.id)}`;
  const [seen, track] = await Promise.all([get<SeenCollection>(`${path}/coverage.geojson`), get<FeatureCollection>(`${path}/track.geojson`)]);
  const lines = track.features.filter((feature): feature is Feature<LineString> => feature.geometry.type === "LineString");
  const pieces = lines.map((feature) => ({
    type: "Feature" as const,
    geometry: feature.geometry,
    properties: { sensor_on: feature.properties?.["role"] === "sensor_on" },
  }));
  flown.set({ flight, seen, track: pieces, photos: track.features.filter((feature) => feature.properties?.["role"] === "photo") });
}

/** The places of a flight as far as it is recorded. */
export async function recordedTrack(id: string): Promise<TrackPoint[]> {
  const { features } = await get<FeatureCollection>(`/flights/${encodeURIComponent(id)}/track.geojson`);
  return features.flatMap(({ geometry, properties: p }) => {
    if (p?.["role"] !== "track" || geometry.type !== "LineString") return [];
    return geometry.coordinates.map((at, i) => ({ at: at.slice(0, 2) as Position, sensor_on: (p["sensor_on"] as (boolean | null)[])[i] === true, time_s: (p["times_s"] as (number | null)[])[i] ?? null }));
  });
}

export const flightUrl = (id: string, file: string): string => apiUrl(`/flights/${encodeURIComponent(id)}/${file}`);

/** What all flights of the same plan saw together stands in for what this one saw. */
export async function showSortie(now: Flown): Promise<void> {
  flown.set({ ...now, seen: await get<SeenCollection>(`/plans/${encodeURIComponent(now.seen.plan)}/coverage`) });
}

/** What a log gave to a flight's record. */
export interface Filled {
  points: number;
  photos: number;
  filled: { start_s: number; end_s: number | null }[];
  left: { start_s: number; end_s: number | null; why: string }[];
}

/** Fill silences of a flight's record from a log of the vehicle's own, or another recording; then show it anew. */
export async function fillFrom(flight: Flight, file: File): Promise<Filled> {
  const filled = await sendFile<Filled>(`/flights/${encodeURIComponent(flight.id)}/log?${new URLSearchParams({ name: file.name })}`, file);
  await refreshFlights();
  await showFlight(flights.value.find(({ id }) => id === flight.id) ?? flight);
  return filled;
}

/** Have the service plan what a flight did not see. */
export function refly(id: string): Promise<PlanRecord> {
  return post<PlanRecord>(`/flights/${encodeURIComponent(id)}/refly`, null);
}

/** When the watched vehicle's flight ends, show what it saw. */
export function keepFlights(): void {
  scenarios.replaced.watch(() => flown.set(null));
  let flying: string | null = null;
  watched.watch((vehicle) => {
    const now = vehicle?.flight_id ?? null;
    if (now !== null && now !== flying) flown.set(null);
    const ended = flying !== null && now === null && vehicle !== null ? flying : null;
    const begun = now !== null && now !== flying;
    flying = vehicle === null ? flying : now;
    if (!ended && !begun) return;
    void attempt("The flights were not listed", async () => {
      await refreshFlights();
      const flight = flights.value.find((candidate) => candidate.id === ended);
      if (!flight?.plan_id) return;
      // What another plan's flight saw belongs to another scenario than the one on the map.
      if (flight.plan_id === open.value?.record.id) await showFlight(flight);
      else news(`${flight.vehicle_name} has ended a flight of another plan than the one on the map; what it saw stands under Flights.`);
    });
  });
}
