/** Vehicles: which there are, the one being watched, what is sent to it. */
import { ApiError, connection, follow, get, list, post, remove } from "./api";
import { bodyOf, type Encoding } from "./encoding";
import { hear } from "./hearing";
import { attempt, report } from "./notices";
import { Signal } from "./signal";
import type { HeldItem, Part, Preflight, Recording, Upload, Vehicle } from "./types";

export type Command = "arm" | "disarm" | "start" | "pause" | "resume" | "hold" | "rtl" | "land" | "sensor_off" | "goto_item";

export interface CommandAnswer {
  outcome: "done" | "accepted" | "pending" | "unknown";
  reason?: string | null;
  detail?: string;
}

export interface Override {
  reason: string;
}

export const vehicles = new Signal<Vehicle[]>([]);
/** The vehicle being watched, as its telemetry last told. */
export const watched = new Signal<Vehicle | null>(null);
/** Whether its telemetry comes in. */
export const stream = new Signal<"none" | "open" | "broken">("none");

const path = (id: string, rest = ""): string => `/vehicles/${encodeURIComponent(id)}${rest}`;

let unfollow: (() => void) | null = null;

export function watchVehicle(id: string | null): void {
  unfollow?.();
  unfollow = null;
  stream.set("none");
  watched.set(vehicles.value.find((vehicle) => vehicle.id === id) ?? null);
  if (id === null) return;
  unfollow = follow(
    path(id, "/telemetry"),
    ({ data }) => {
      const vehicle = data as Vehicle | null;
      if (vehicle?.id !== id) return;
      hear(vehicle);
      watched.set(vehicle);
    },
    (state) => {
      if (stream.value !== state) stream.set(state);
    },
    (error) => {
      stream.set("none");
      watched.set(null);
      // A vehicle that was let go, or that a restarted service does not know.
      if (error.status !== 404) report("The vehicle cannot be watched", error);
      void attempt("The vehicles were not listed", refreshVehicles);
    },
  );
}

/** List the vehicles; the first one is watched when none is. */
export async function refreshVehicles(): Promise<void> {
  const found = await list<Vehicle>("/vehicles", "vehicles");
  found.forEach((vehicle) => hear(vehicle));
  vehicles.set(found);
  const known = vehicles.value.some((vehicle) => vehicle.id === watched.value?.id);
  if (!known) watchVehicle(vehicles.value[0]?.id ?? null);
}

export async function connectVehicle(name: string, url: string): Promise<Vehicle> {
  const vehicle = await post<Vehicle>("/vehicles", { name, url });
  await refreshVehicles();
  watchVehicle(vehicle.id);
  return vehicle;
}

export async function letGo(id: string, inFlight = false): Promise<void> {
  await remove(inFlight ? path(id, "?in_flight=true") : path(id));
  if (watched.value?.id === id) watchVehicle(null);
  await refreshVehicles();
}

export function upload(id: string, planId: string, vehicle: string | null, parts: Part[], how: Encoding, override: Override | null): Promise<Upload> {
  const excuse = override ? { override: true, reason: override.reason } : {};
  return answered(post<Upload>(path(id, "/mission"), { plan_id: planId, ...(vehicle ? { vehicle } : {}), parts, ...bodyOf(how), ...excuse }));
}

/** What an upload came to; one that the vehicle refused, or holds otherwise, tells it in its problem document. */
export async function answered<T>(sent: Promise<T>): Promise<T> {
  try {
    return await sent;
  } catch (error) {
    if (error instanceof ApiError && error.problem.type?.endsWith(":not-held")) return error.problem as unknown as T;
    throw error;
  }
}

/** Ask the vehicle whether it is ready to fly a plan; nothing in it is changed. */
export function preflight(id: string, planId: string, vehicle: string | null, how: Encoding): Promise<Preflight> {
  return post<Preflight>(path(id, "/preflight"), { plan_id: planId, ...(vehicle ? { vehicle } : {}), ...bodyOf(how) });
}

/** Take the aircraft that answers in the vehicle's place for the vehicle. */
export function acknowledge(id: string, systemId: number): Promise<Vehicle> {
  return post<Vehicle>(path(id, "/identity"), { system_id: systemId });
}

/** Say at which address of its port the vehicle is. */
export function acknowledgeAddress(id: string, address: string): Promise<Vehicle> {
  return post<Vehicle>(path(id, "/address"), { address });
}

export function command(id: string, name: Command, more: { seq?: number; arm_first?: true } = {}): Promise<CommandAnswer> {
  return post<CommandAnswer>(path(id, "/commands"), { command: name, ...more });
}

const PARTS: Part[] = ["mission", "fence", "rally"];
const query = (parts: Part[]): string => parts.map((part) => `part=${part}`).join("&");

/** Read what the vehicle holds, part by part. */
export async function download(id: string): Promise<Record<Part, HeldItem[]>> {
  return (await get<{ parts: Record<Part, HeldItem[]> }>(path(id, `/mission?${query(PARTS)}`))).parts;
}

/** Empty the vehicle's lists. */
export async function clear(id: string): Promise<Record<Part, "accepted" | "refused" | "unknown">> {
  return ((await remove(path(id, `/mission?${query(PARTS)}`))) as { parts: Record<Part, "accepted" | "refused" | "unknown"> }).parts;
}

export const recordings = (id: string): Promise<{ failure: string | null; logs: Recording[] }> => get(path(id, "/logs"));

export const readVehicle = (id: string): Promise<Vehicle> => get<Vehicle>(path(id));

/** Keep the list fresh while the page is open: others may connect vehicles too. */
export function keepVehicles(): void {
  const every_ms = 2000;
  const beat = async (): Promise<void> => {
    if (connection.value === "up" && !document.hidden) {
      try {
        await refreshVehicles();
      } catch {
        // The loss of the service shows in the header; the next beat tries again.
      }
    }
    setTimeout(() => void beat(), every_ms);
  };
  connection.watch((state) => {
    if (state === "up" && vehicles.value.length === 0) void attempt("The vehicles were not listed", refreshVehicles);
  });
  setTimeout(() => void beat(), every_ms);
}
