/** Vehicles: which there are, the one being watched, what is sent to it. */
import { connection, follow, get, list, post, remove } from "./api";
import { attempt, report } from "./notices";
import { Signal } from "./signal";
import type { Preflight, Upload, Vehicle } from "./types";

export type Command = "arm" | "disarm" | "start" | "pause" | "resume" | "rtl";

export interface CommandAnswer {
  outcome: "accepted" | "unknown";
  detail: string;
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
      if (vehicle?.id === id) watched.set(vehicle);
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
  vehicles.set(await list<Vehicle>("/vehicles", "vehicles"));
  const known = vehicles.value.some((vehicle) => vehicle.id === watched.value?.id);
  if (!known) watchVehicle(vehicles.value[0]?.id ?? null);
}

export async function connectVehicle(name: string, url: string): Promise<void> {
  const vehicle = await post<Vehicle>("/vehicles", { name, url });
  await refreshVehicles();
  watchVehicle(vehicle.id);
}

export async function letGo(id: string): Promise<void> {
  await remove(path(id));
  if (watched.value?.id === id) watchVehicle(null);
  await refreshVehicles();
}

export function upload(id: string, planId: string, parts: string[], override: Override | null): Promise<Upload> {
  const excuse = override ? { override: true, reason: override.reason } : {};
  return post<Upload>(path(id, "/mission"), { plan_id: planId, parts, ...excuse });
}

/** Ask the vehicle whether it is ready to fly a plan; nothing in it is changed. */
export function preflight(id: string, planId: string): Promise<Preflight> {
  return post<Preflight>(path(id, "/preflight"), { plan_id: planId });
}

export function command(id: string, name: Command): Promise<CommandAnswer> {
  return post<CommandAnswer>(path(id, "/commands"), { command: name });
}

export const readVehicle = (id: string): Promise<Vehicle> => get<Vehicle>(path(id));

/** Keep the list fresh while the page is open: others may connect vehicles too. */
export function keepVehicles(): void {
  const every_ms = 5000;
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
