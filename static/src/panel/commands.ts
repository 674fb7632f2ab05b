/** Explicit flight commands: each says what will move, asks back, and tells what the vehicle answered. */
import { ApiError } from "../api";
import { ask } from "../dialog";
import { button, h } from "../dom";
import { command, watched, type CommandAnswer } from "../fleet";
import { hearing } from "../hearing";
import { news, report, warn } from "../notices";
import { awaitEnd, lookSoon } from "../ordered";
import type { Vehicle } from "../types";
import { ORDERS, saying, type Order } from "./orders";

const MOST_ITEMS = 65_535;
const UNKNOWN = 504;

function tell(vehicle: Vehicle, order: Order, answer: CommandAnswer): void {
  const why = answer.reason ?? answer.detail ?? "";
  if (answer.outcome === "unknown") warn(`${order.label}: ${vehicle.name} did not confirm it`, why, "Look at what it does before it is told again.");
  else if (answer.outcome === "pending") {
    news(`${order.label}: ${vehicle.name} took it and is at it. ${why}`);
    awaitEnd(vehicle.id, order.name);
  }
  else news(`${order.label}: ${vehicle.name} confirmed it.`);
}

async function give(vehicle: Vehicle, order: Order, seq: number | null = null): Promise<void> {
  if ((await ask(saying(vehicle, order, seq))) !== null) await giveNow(vehicle, order, seq);
}

/** Give an order that has been asked back. */
export async function giveNow(vehicle: Vehicle, order: Order, seq: number | null = null): Promise<void> {
  const armFirst = order.name === "start" && !vehicle.state.armed ? { arm_first: true as const } : {};
  lookSoon();
  try {
    tell(vehicle, order, await command(vehicle.id, order.name, { ...(seq === null ? {} : { seq }), ...armFirst }));
  } catch (error) {
    const unknown = error instanceof ApiError && error.status === UNKNOWN;
    report(unknown ? `${order.label}: whether ${vehicle.name} does it is not known` : `${order.label}: the command was not carried out`, error);
  }
  lookSoon();
}

/** Why an order cannot be given; empty when it can. What makes safe is sent to one that is silent, too. */
function shut(vehicle: Vehicle | null, order?: Order): string {
  if (!vehicle) return "No vehicle is chosen.";
  if (vehicle.replay) return "A recording takes no commands.";
  if (order?.name === "land" && vehicle.state.type === "fixed_wing") {
    if (!vehicle.connected) return "A fixed wing lands by its mission, which is not set going unheard: Return is sent to it, too.";
    if (vehicle.mission_lands === false) return "A fixed wing lands by its mission, and the one it holds has no landing: send Return or Hold, and land it by hand; or plan it to end with a landing.";
  }
  if (vehicle.connected) return "";
  if (!hearing(vehicle).lost) return "It is not heard: no command reaches it.";
  return order?.urgent ? "" : "Its link is lost: hold, return, sensor off, and land of one that hovers, alone are sent to it.";
}

export function commands(): HTMLElement {
  const made = ORDERS.map((order) => ({
    order,
    control: button(order.label, () => watched.value && void give(watched.value, order), { "data-command": order.name, class: order.urgent ? "urgent" : "" }),
  }));
  const item = h("input", { id: "goto-item", type: "number", min: 0, max: MOST_ITEMS, step: 1, required: true, "aria-label": "Number of the mission item to go to", placeholder: "no." });
  const goTo = h("button", { type: "submit", "data-command": "goto_item" }, "Go to item");
  const form = h("form", { class: "joined narrow" }, goTo, item);
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    const seq = item.valueAsNumber;
    const order: Order = { name: "goto_item", label: `Go to item ${seq}`, title: "" };
    if (watched.value) void give(watched.value, order, seq);
  });
  watched.watch((vehicle) => {
    for (const { order, control } of made) {
      const why = shut(vehicle, order);
      control.disabled = why !== "";
      control.title = why || order.title;
    }
    const why = shut(vehicle);
    goTo.disabled = item.disabled = why !== "";
    goTo.title = why || "Goes on with the mission from the item of this number";
  });
  const of = (urgent: boolean): HTMLElement[] => made.filter(({ order }) => (order.urgent ?? false) === urgent).map(({ control }) => control);
  return h(
    "div",
    { role: "group", "aria-label": "Flight commands" },
    h("div", { class: "row" }, ...of(false), form),
    h("div", { class: "row", role: "group", "aria-label": "In flight, at once" }, ...of(true)),
  );
}
