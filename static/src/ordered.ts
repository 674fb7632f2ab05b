/** What was ordered of the watched vehicle, from this tab or any other, and what became of it: as the audit has it. */
import { connection, get } from "./api";
import { watched } from "./fleet";
import { news, warn } from "./notices";
import { planName } from "./holding";
import { Signal } from "./signal";

export interface Ordered {
  number: number;
  at: string;
  actor: string;
  kind: "order" | "upload" | "clear" | "override" | "acknowledgement" | "signing";
  vehicle_id: string;
  vehicle_name: string;
  what: Record<string, unknown>;
  outcome: string;
  reason: string;
  ended_at: string | null;
}

export const ordered = new Signal<Ordered[]>([]);

const MOST = 30;
const SOON_MS = 250;
const PENDING_MS = 1000;
const SETTLED_MS = 6000;
const LABELS: Record<string, string> = {
  arm: "Arm", disarm: "Disarm", start: "Start mission", pause: "Pause", resume: "Resume", hold: "Hold", rtl: "Return", land: "Land", sensor_off: "Sensor off", goto_item: "Go to item",
};
const KINDS: Record<Ordered["kind"], string> = {
  order: "Order", upload: "Upload", clear: "Clear", override: "Override", acknowledgement: "Acknowledged", signing: "Signing",
};

/** An entry in a few words. */
export function orderWords({ kind, what }: Ordered): string {
  if (kind === "order") {
    const name = LABELS[String(what["command"])] ?? String(what["command"]);
    const item = typeof what["seq"] === "number" ? ` ${what["seq"]}` : "";
    return `${name}${item}${what["arm_first"] === true ? ", armed first" : ""}`;
  }
  const parts = Array.isArray(what["parts"]) ? ` (${what["parts"].join(", ")})` : "";
  const plan = typeof what["plan_id"] === "string" ? ` of ${planName(what["plan_id"])}` : "";
  const why = kind === "override" && typeof what["reason"] === "string" ? `: “${what["reason"]}”` : "";
  return `${KINDS[kind]}${plan}${parts}${why}`;
}

/** Commands that this tab was told are pending: their end is said aloud, others' stands in the list. */
const awaited = new Set<string>();

/** Remember that the answer to a command was `pending`. */
export function awaitEnd(vehicleId: string, command: string): void {
  awaited.add(`${vehicleId}/${command}`);
  lookSoon();
}

function tellEnds(found: Ordered[]): void {
  for (const key of awaited) {
    const entry = found.find(({ kind, vehicle_id, what }) => kind === "order" && `${vehicle_id}/${String(what["command"])}` === key);
    if (!entry || entry.outcome === "pending") continue;
    awaited.delete(key);
    const name = orderWords(entry);
    if (entry.outcome === "done") news(`${name}: ${entry.vehicle_name} has done it.`);
    else warn(`${name}: ${OUTCOMES[entry.outcome] ?? entry.outcome}`, entry.reason);
  }
}

export const OUTCOMES: Record<string, string> = {
  pending: "under way", done: "done", accepted: "done", refused: "refused", overtaken: "overtaken by a newer order", unknown: "not known whether it was done", different: "the vehicle holds something else",
};

let asked = 0;

async function refreshOrdered(): Promise<void> {
  const vehicle = watched.value;
  if (!vehicle) return;
  const mine = (asked += 1);
  const { entries } = await get<{ entries: Ordered[] }>(`/audit?limit=${MOST}&vehicle=${encodeURIComponent(vehicle.id)}`);
  if (mine !== asked || watched.value?.id !== vehicle.id) return;
  if (JSON.stringify(entries) !== JSON.stringify(ordered.value)) ordered.set(entries);
  tellEnds(entries);
}

let timer: ReturnType<typeof setTimeout> | undefined;

/** Look again after a moment, and go on looking: often while something is under way. */
function lookIn(pause_ms: number): void {
  clearTimeout(timer);
  timer = setTimeout(() => void look(), pause_ms);
}

async function look(): Promise<void> {
  if (connection.value === "up" && !document.hidden) {
    try {
      await refreshOrdered();
    } catch {
      // The loss of the service shows in the header; the next look tries again.
    }
  }
  const moving = awaited.size > 0 || ordered.value.some(({ outcome }) => outcome === "pending");
  lookIn(moving ? PENDING_MS : SETTLED_MS);
}

/** Something was just ordered. */
export const lookSoon = (): void => lookIn(SOON_MS);

/** Keep the list as the audit has it. */
export function keepOrdered(): void {
  let vehicle: string | null = null;
  watched.watch((now) => {
    if ((now?.id ?? null) === vehicle) return;
    vehicle = now?.id ?? null;
    ordered.set([]);
    lookIn(0);
  });
  connection.watch((state) => state === "up" && lookIn(0));
}
