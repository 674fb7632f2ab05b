/** Where aircraft go on with a mission that took the place of theirs in flight, and the order to begin it instead. */
import { ask } from "../dialog";
import { button, h } from "../dom";
import { vehicles } from "../fleet";
import type { Upload } from "../types";
import { giveNow } from "./commands";
import { saying, type Order } from "./orders";

/** The item after home: where a mission begins. */
const FIRST = 1;
const BEGIN: Order = { name: "goto_item", label: `Go to item ${FIRST}`, title: "" };

/** An aircraft goes on at the number it was at: of a new mission that is anywhere. */
export function goesOn(sent: { id: string; upload: Upload }[]): HTMLElement | null {
  const flying = sent.flatMap(({ id, upload }) => (upload.in_flight ? [{ id, ...upload.in_flight }] : []));
  if (flying.length === 0) return null;
  const late = flying.filter(({ item }) => item === null || item > FIRST);
  const begin = async (): Promise<void> => {
    const those = late.flatMap(({ id }) => vehicles.value.filter((vehicle) => vehicle.id === id));
    const lines = those.flatMap((vehicle) => saying(vehicle, BEGIN, FIRST).lines);
    if ((await ask({ title: `Begin the new mission${those.length > 1 ? "s" : ""} now?`, lines, go: "Begin now" })) === null) return;
    await Promise.all(those.map((vehicle) => giveNow(vehicle, BEGIN, FIRST)));
  };
  return h(
    "div",
    { class: "goes-on" },
    ...flying.map(({ id, message }) => h("p", { class: "warning" }, `${vehicles.value.find((vehicle) => vehicle.id === id)?.name ?? ""}: ${message}`)),
    late.length === 0 ? null : h("div", { class: "row" }, button(late.length > 1 ? "Begin the new missions now" : "Begin the new mission now", () => void begin(), { class: "urgent", title: `Tells ${late.length > 1 ? "each of them" : "it"} to go to item ${FIRST}`, "data-begin": "" })),
  );
}
