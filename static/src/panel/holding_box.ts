/** What the vehicle holds, as far as the service knows; reading it, clearing it, and the link's recordings. */
import { ask } from "../dialog";
import { button, fill, h, section } from "../dom";
import { clear, download, recordings, watched } from "../fleet";
import { held } from "../held";
import { planName } from "../holding";
import { attempt, news, warn } from "../notices";
import { open, recent } from "../plans";
import type { HeldItem, Part, Sent } from "../types";
import { metres } from "../units";

const ITEMS_SHOWN = 400;
const MEGABYTE = 1e6;

function standing(sent: Sent | null): [words: string, tone: string] {
  if (!sent) return ["Nothing was sent to it from here, or it was cleared.", "quiet"];
  const plan = planName(sent.plan_id);
  const when = sent.read_back_at ? ` at ${new Date(sent.read_back_at).toLocaleTimeString()}` : "";
  if (sent.standing === "held") return sent.shown_by === "read_back" ? [`It holds ${plan}: read back equal${when}.`, "good"] : [`It seems to hold ${plan}, by the id of its list; Check before flight compares it.`, "warning"];
  if (sent.standing === "differs") return [`It does NOT hold what was sent (${plan}): ${sent.shown_by === "read_back" ? `what was read back${when} differs` : "its list has another id now"}. Upload again, or read what it holds.`, "error"];
  return [`${plan[0]?.toUpperCase()}${plan.slice(1)} was sent; whether it is still held is not known. Check before flight reads it back.`, "warning"];
}

function itemTable(items: HeldItem[]): HTMLElement {
  const place = (item: HeldItem): string => (item.lat_deg === undefined || item.lon_deg === undefined ? "" : `${item.lat_deg.toFixed(5)}, ${item.lon_deg.toFixed(5)}`);
  return h(
    "table",
    { class: "compare" },
    h("thead", {}, h("tr", {}, h("th", { scope: "col" }, "No."), h("th", { scope: "col" }, "Command"), h("th", { scope: "col" }, "Latitude, longitude"), h("th", { scope: "col" }, "Height"))),
    h(
      "tbody",
      {},
      ...items.slice(0, ITEMS_SHOWN).map((item) =>
        h("tr", {}, h("td", {}, item.seq), h("td", {}, (item.command_name ?? String(item.command)).replaceAll("_", " ").toLowerCase()), h("td", {}, place(item)), h("td", {}, place(item) ? metres(item.altitude_m) : "")),
      ),
    ),
  );
}

export function holdingBox(): HTMLElement {
  const known = h("p", { id: "sent", role: "status" });
  const found = h("div", { id: "held" });
  const read = button("Read from the vehicle", () => void reading(), { id: "read-held", title: "Downloads mission, fence and rally points; the mission is drawn on the map" });
  const empty = button("Clear …", () => void clearing(), { class: "danger", id: "clear-held" });
  const logs = h("ul", { class: "plain", id: "logs" });
  const logbook = section("Recordings of the link", false, logs);
  const reading = async (): Promise<void> => {
    const vehicle = watched.value;
    if (!vehicle) return;
    fill(found, h("p", {}, `Reading from ${vehicle.name} …`));
    const parts = await attempt(`${vehicle.name} could not be read`, () => download(vehicle.id));
    if (watched.value?.id !== vehicle.id) return;
    held.set(parts ? { vehicle: vehicle.id, items: parts.mission } : null);
    fill(
      found,
      parts
        ? h("div", {}, ...(Object.entries(parts) as [Part, HeldItem[]][]).map(([part, items]) => (items.length > 0 ? section(`${part}: ${items.length} items`, false, itemTable(items)) : h("p", {}, `${part}: empty`))))
        : null,
    );
  };
  const clearing = async (): Promise<void> => {
    const vehicle = watched.value;
    if (!vehicle) return;
    const lines = ["Mission, fence and rally points are taken out of the vehicle.", ...(vehicle.state.armed ? ["It is armed. Without a mission it does what its firmware does then."] : [])];
    if ((await ask({ title: `Clear ${vehicle.name}?`, lines, go: "Clear" })) === null) return;
    const outcomes = await attempt(`${vehicle.name} was not cleared`, () => clear(vehicle.id));
    if (!outcomes) return;
    held.set(null);
    fill(found);
    const wrong = Object.entries(outcomes).filter(([, outcome]) => outcome !== "accepted");
    if (wrong.length > 0) warn(`${vehicle.name} was not cleared`, ...wrong.map(([part, outcome]) => `${part}: ${outcome}`));
    else news(`${vehicle.name} holds nothing any more.`);
  };
  const list = async (): Promise<void> => {
    const vehicle = watched.value;
    if (!vehicle || !logbook.open) return;
    const answer = await attempt("The recordings were not listed", () => recordings(vehicle.id));
    if (!answer || watched.value?.id !== vehicle.id) return;
    fill(
      logs,
      answer.failure ? h("li", { class: "error" }, `The link is no longer recorded: ${answer.failure}`) : null,
      ...answer.logs.map((log) => h("li", {}, h("a", { href: log.url, download: log.name }, log.name), h("span", { class: "quiet" }, ` ${(log.size_bytes / MEGABYTE).toFixed(1)} MB`))),
      answer.logs.length === 0 ? h("li", { class: "quiet" }, "None: recordings are not recorded again, and recording can be switched off.") : null,
    );
  };
  logbook.addEventListener("toggle", () => void list());
  let shown: string | null = null;
  const update = (): void => {
    const vehicle = watched.value;
    const [words, tone] = standing(vehicle?.sent ?? null);
    known.hidden = !vehicle || vehicle.replay;
    known.className = tone;
    if (known.textContent !== words) known.textContent = words;
    read.disabled = empty.disabled = !vehicle?.connected || vehicle.replay || vehicle.operation !== null;
    if ((vehicle?.id ?? null) === shown) return;
    shown = vehicle?.id ?? null;
    held.set(null);
    fill(found);
    fill(logs);
    void list();
  };
  watched.watch(update);
  open.watch(update);
  recent.watch(update);
  return section("What the vehicle holds", true, known, h("div", { class: "row" }, read, empty), found, logbook);
}
