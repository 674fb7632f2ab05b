/** Which vehicles there are, and the one being watched. */
import { ask } from "../dialog";
import { button, fill, h, section } from "../dom";
import { letGo, vehicles, watched, watchVehicle } from "../fleet";
import { attempt } from "../notices";
import type { Vehicle } from "../types";
import { connectForm } from "./connect_form";

function standing(vehicle: Vehicle): string {
  if (vehicle.connected) return vehicle.replay ? "recording" : vehicle.simulated ? "simulated" : "connected";
  if (vehicle.other_system !== null) return "another aircraft";
  return vehicle.link_failure ? "no link" : "not heard";
}

async function release(vehicle: Vehicle): Promise<void> {
  const flying = vehicle.state.armed ? ["It is armed and may be in flight: nobody here hears, records or orders it any more. The aircraft itself gets no command."] : ["The link is closed; the vehicle gets no command."];
  const sure = await ask({ title: `Let ${vehicle.name} go?`, lines: flying, go: "Let go" });
  if (sure !== null) await attempt(`${vehicle.name} was not let go`, () => letGo(vehicle.id, vehicle.state.armed || Boolean(vehicle.flight_id)));
}

export function vehicleList(): HTMLElement {
  const items = h("div", { role: "radiogroup", "aria-label": "Vehicles", id: "vehicles" });
  const connect = section("Connect a vehicle", false, connectForm());
  let shown = "";
  const draw = (): void => {
    const key = JSON.stringify([watched.value?.id, vehicles.value.map((vehicle) => [vehicle.id, standing(vehicle), vehicle.name])]);
    if (key === shown) return;
    shown = key;
    const focused = items.contains(document.activeElement) ? document.activeElement?.id : undefined;
    fill(
      items,
      ...vehicles.value.map((vehicle) =>
        h(
          "div",
          { class: "vehicle" },
          h("input", { type: "radio", name: "vehicle", id: `v-${vehicle.id}`, checked: vehicle.id === watched.value?.id, onchange: () => watchVehicle(vehicle.id) }),
          h("label", { for: `v-${vehicle.id}`, title: `${vehicle.name}\n${vehicle.url}` }, h("strong", {}, vehicle.name), ` ${vehicle.url}`),
          h("span", { class: vehicle.connected ? "good" : "error" }, standing(vehicle)),
          button("Let go", () => void release(vehicle), { class: "link", id: `go-${vehicle.id}`, "aria-label": `Let ${vehicle.name} go` }),
        ),
      ),
      vehicles.value.length === 0 ? h("p", { class: "quiet" }, "No vehicle is connected. Connect one below, or a simulated one to try.") : null,
    );
    if (focused) document.getElementById(focused)?.focus();
  };
  vehicles.watch(draw);
  watched.watch(draw);
  return h("div", {}, items, connect);
}
