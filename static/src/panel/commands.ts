/** Explicit flight commands: each asks back, and says what the vehicle answered. */
import { ask } from "../dialog";
import { button, h } from "../dom";
import { command, watched, type Command } from "../fleet";
import { attempt, news, warn } from "../notices";
import { open } from "../plans";
import type { Vehicle } from "../types";

interface Order {
  name: Command;
  label: string;
  says: string;
}

const ORDERS: Order[] = [
  { name: "arm", label: "Arm", says: "The motors may start." },
  { name: "start", label: "Start mission", says: "The aircraft takes off and flies the mission it holds." },
  { name: "pause", label: "Pause", says: "The aircraft leaves its line and waits: in a circle, or hovering." },
  { name: "resume", label: "Resume", says: "The aircraft goes on with the mission." },
  { name: "rtl", label: "Return (RTL)", says: "The aircraft gives up the mission and returns to launch." },
  { name: "disarm", label: "Disarm", says: "The motors stop; an aircraft in flight refuses it." },
];
const MOST_ITEMS = 65_535;

async function give(vehicle: Vehicle, order: Order, seq: number | null = null): Promise<void> {
  const lines = [order.says];
  if (order.name === "start" && open.value && open.value.record.id !== vehicle.plan_id) lines.push("That is not known to be the plan on the map.");
  const sure = await ask({ title: `${order.label}: ${vehicle.name}?`, lines, go: order.label });
  if (sure === null) return;
  const answer = await attempt(`${order.label}: the command was not carried out`, () => command(vehicle.id, order.name, seq));
  if (answer?.outcome === "unknown") warn(`${order.label}: ${vehicle.name} did not confirm it`, answer.detail);
  else if (answer) news(`${order.label}: ${vehicle.name} confirmed it.`);
}

export function commands(): HTMLElement {
  const buttons = ORDERS.map((order) => button(order.label, () => watched.value && void give(watched.value, order), { "data-command": order.name, title: order.says }));
  const item = h("input", { id: "goto-item", type: "number", min: 0, max: MOST_ITEMS, step: 1, required: true, "aria-label": "Number of the mission item to go to", placeholder: "no." });
  const goTo = h("button", { type: "submit", "data-command": "goto_item", title: "Goes on with the mission from the item of this number" }, "Go to item");
  const form = h("form", { class: "joined narrow" }, goTo, item);
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    const seq = item.valueAsNumber;
    const order: Order = { name: "goto_item", label: `Go to item ${seq}`, says: `The aircraft leaves what it does and goes on with the mission from item ${seq}.` };
    if (watched.value) void give(watched.value, order, seq);
  });
  watched.watch((vehicle) => {
    const possible = vehicle !== null && vehicle.connected && !vehicle.replay;
    for (const made of [...buttons, goTo, item]) made.disabled = !possible;
  });
  return h("div", { class: "row", role: "group", "aria-label": "Flight commands" }, ...buttons, form);
}
