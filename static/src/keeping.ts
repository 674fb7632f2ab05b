/** The scenario of this tab, kept by the service under an id of its own; two tabs never write over each other. */
import { ApiError, connection, get, list, post, put, remove } from "./api";
import { canonical } from "./canonical";
import { ask } from "./dialog";
import { attempt, news, report, warn } from "./notices";
import { scenarios } from "./scenario";
import { debounce, Signal } from "./signal";
import type { KeptRecord, KeptText, Scenario } from "./types";

const QUIET_MS = 900;
const ABSENT = new Set([404, 405]);
const CHANGED = 412;

/**
 * `shown`: as the service has it, nothing to keep. `tab`: in this tab alone, as the service keeps no scenarios.
 * `changed`: another tab saved meanwhile; nothing is written until the operator has chosen.
 */
export type KeepState = "shown" | "waiting" | "kept" | "tab" | "changed" | "failed";

export interface Keeping {
  id: string | null;
  tag: string;
  state: KeepState;
}

/** A scenario while it is, or was, on the page: what of it is still to be written. */
interface Subject extends Keeping {
  pending: Scenario | null;
}

const fresh = (): Subject => ({ id: null, tag: "", state: "shown", pending: null });

let subject = fresh();
let saving: Promise<void> = Promise.resolve();

export const keeping = new Signal<Keeping>(subject);
/** Scenarios the service keeps, newest first; null where it keeps none. */
export const keptScenarios = new Signal<KeptRecord[] | null>(null);

const place = (id: string): string => `/scenarios/${encodeURIComponent(id)}`;
const tagOf = ({ revision }: KeptRecord): string => `"${revision}"`;

export async function refreshKept(): Promise<void> {
  try {
    const found = await list<KeptRecord>("/scenarios", "scenarios");
    keptScenarios.set([...found].sort((a, b) => b.changed_at.localeCompare(a.changed_at)));
  } catch (error) {
    if (!(error instanceof ApiError && ABSENT.has(error.status))) throw error;
    keptScenarios.set(null);
  }
}

/** Tell what became of a scenario; of one no longer on the page only what went wrong is told. */
function settle(of: Subject, change: Partial<Subject>): void {
  Object.assign(of, change);
  if (of === subject) keeping.set({ id: of.id, tag: of.tag, state: of.state });
}

/** Take over a kept scenario's id, so that edits go there. */
export function adopt(id: string, tag: string): void {
  settle(subject, { id, tag, state: "kept", pending: null });
}

/** Put a kept scenario on the page, unless something else is wanted there by the time it has come; tells whether it was. */
export async function openKept(id: string, wanted: () => boolean = () => true): Promise<boolean> {
  const record = await get<KeptText>(place(id));
  if (!wanted()) return false;
  scenarios.load(record.scenario, false);
  adopt(id, tagOf(record));
  return true;
}

export async function deleteKept(id: string): Promise<void> {
  await remove(place(id));
  if (subject.id === id) settle(subject, { id: null, tag: "", state: "shown", pending: null });
  await refreshKept();
}

async function write(of: Subject): Promise<void> {
  const document = of.pending;
  if (document === null || of.state === "changed") return;
  of.pending = null;
  try {
    const record = of.id === null ? await post<KeptRecord>("/scenarios", document) : await put<KeptRecord>(place(of.id), document, of.tag);
    settle(of, { id: record.id, tag: tagOf(record), state: of.pending === null ? "kept" : "waiting" });
    void refreshKept().catch(() => undefined);
  } catch (error) {
    of.pending ??= document;
    const status = error instanceof ApiError ? error.status : 0;
    if (of.id === null && ABSENT.has(status)) return settle(of, { state: "tab" });
    if (of.id !== null && status === 404) {
      // Deleted meanwhile: it is kept anew.
      settle(of, { id: null, tag: "", state: "waiting" });
      return write(of);
    }
    settle(of, { state: status === CHANGED ? "changed" : "failed" });
    if (status === CHANGED) warn("Another tab changed this scenario", "Nothing of it was written over. Choose under Scenario which of the two this tab goes on with.");
    else if (error instanceof ApiError) report("The scenario was not kept by the service", error);
  }
}

/** Write what is not written yet; one after the other. */
export function keepNow(): Promise<void> {
  const of = subject;
  saving = saving.then(() => write(of));
  return saving;
}

/** Go on with what the other tab saved; what was edited here is gone then. */
export async function takeTheirs(): Promise<void> {
  const { id } = subject;
  if (id === null) return;
  const lines = ["What was edited in this tab since is lost. Download it first, or keep it as a scenario of its own, if it is still needed."];
  if ((await ask({ title: "Go on with the other tab's scenario?", lines, go: "Take the other one" })) !== null) await openKept(id);
}

/** Keep what this tab has as a scenario of its own, beside the other tab's. */
export async function keepBeside(): Promise<void> {
  const copy = { ...scenarios.document.value, name: `${scenarios.document.value.name ?? "untitled"} (copy)` };
  subject.pending = null;
  scenarios.load(copy, true);
  await keepNow();
  news(`This tab goes on with “${copy.name}”.`);
}

/** What a reload of this tab brought back, with the id it is kept under. */
export function resume(before: Keeping): void {
  const written = before.state === "kept" || before.state === "shown" || scenarios.document.value.features.length === 0;
  settle(subject, { ...before, pending: written ? null : scenarios.document.value });
  if (!written) void keepNow();
}

/** Keep every edit a moment after it was made, and what could not be written when the service is back. */
export function keepScenarios(): void {
  const soon = debounce(() => void keepNow(), QUIET_MS);
  scenarios.replaced.watch(() => {
    // The last edits of the scenario before are written all the same.
    void keepNow();
    subject = fresh();
    keeping.set(subject);
  });
  let shown = scenarios.document.value;
  scenarios.document.watch((document) => {
    const same = document === shown;
    shown = document;
    if (same || !scenarios.edited.value || (document.features.length === 0 && subject.id === null)) return;
    const held = subject.state === "tab" || subject.state === "changed";
    settle(subject, { pending: document, state: held ? subject.state : "waiting" });
    soon();
  });
  connection.watch((state) => {
    if (state !== "up") return;
    void attempt("The kept scenarios were not listed", refreshKept);
    if (subject.state === "failed") soon();
  });
  addEventListener("pagehide", () => void keepNow());
  addEventListener("beforeunload", (event) => {
    // A reload brings back what the tab holds; closing the tab would lose what the service could not take.
    if (subject.state === "failed" || subject.state === "changed") event.preventDefault();
  });
}

/** Edits of a plan's scenario go to the kept one it was made of, where that still is the same. */
export async function adoptIfSame(id: string | null | undefined): Promise<void> {
  const of = subject;
  if (!id || of.state !== "shown") return;
  const record = await get<KeptText>(place(id));
  if (canonical(record.scenario) === scenarios.canonical() && of === subject && of.state === "shown") adopt(id, tagOf(record));
}
