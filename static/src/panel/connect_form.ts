/** Connecting a vehicle: how it is reached, in words, with an address to begin from. */
import { completed } from "../airframes";
import { button, fill, h } from "../dom";
import { connectVehicle, refreshVehicles, vehicles } from "../fleet";
import { attempt, warn } from "../notices";
import { scenarios } from "../scenario";

interface Kind {
  label: string;
  address: () => string;
  hint: string;
}

/** A simulated aircraft that flies as the scenario's first vehicle is said to. */
function simulated(type: "fixed_wing" | "multirotor"): string {
  const vehicle = completed(scenarios.document.value.vehicles?.[0] ?? {});
  const options: Record<string, unknown> = { speedup: 10, type };
  if ((vehicle["type"] ?? "fixed_wing") === type) {
    options["airspeed"] = vehicle["airspeed_m_s"];
    options["turn_radius"] = vehicle["min_turn_radius_m"];
  }
  options["autopilot"] = vehicle["autopilot"];
  const given = Object.entries(options).filter(([, value]) => value !== undefined && value !== null);
  return `sim:?${given.map(([name, value]) => `${name}=${String(value)}`).join("&")}`;
}

const SIMULATED = "Flies on this computer, ten times as fast as life, as the scenario's aircraft says; it stands where the plan begins. Also understood: home=lat,lon, wind=speed,from, speedup=1.";
const KINDS: Record<string, Kind> = {
  udpin: { label: "UDP, listen for it (radios, simulators)", address: () => "udpin:127.0.0.1:14550", hint: "The vehicle, its radio or a simulator sends to this port; another ground station must not hold it. 0.0.0.0 listens on every network, where the service's settings allow it." },
  udpout: { label: "UDP, call it", address: () => "udpout:192.168.1.10:14550", hint: "Address and port of the vehicle or its bridge, where it listens; beyond this computer it has to be in SWATHPLAN_LINK_HOSTS." },
  tcp: { label: "TCP, call it (SITL, bridges)", address: () => "tcp:127.0.0.1:5760", hint: "Address and port of the vehicle's or simulator's TCP server." },
  serial: { label: "Serial port (USB, telemetry radio)", address: () => "serial:/dev/ttyUSB0:57600", hint: "Device and baud rate: 57600 for most radios, 115200 by USB. The port is that of the computer the service runs on, and has to be in SWATHPLAN_SERIAL_PORTS." },
  sim_fixed_wing: { label: "Simulated fixed wing", address: () => simulated("fixed_wing"), hint: SIMULATED },
  sim_multirotor: { label: "Simulated multirotor", address: () => simulated("multirotor"), hint: SIMULATED },
  replay: { label: "Recording (.tlog), played back", address: () => "replay:/path/to/flight.tlog?speedup=10", hint: "A file on the computer the service runs on. With &plan=<id> what it saw of that plan is judged. It takes no commands." },
};

function freeName(): string {
  const taken = new Set(vehicles.value.map((vehicle) => vehicle.name));
  for (let number = 1; ; number += 1) if (!taken.has(`uav-${number}`)) return `uav-${number}`;
}

export function connectForm(): HTMLElement {
  const kind = h("select", { id: "v-kind" }, ...Object.entries(KINDS).map(([id, { label }]) => h("option", { value: id }, label)));
  const name = h("input", { id: "v-name", type: "text", required: true, maxlength: 100, autocomplete: "off" });
  const url = h("input", { id: "v-url", type: "text", required: true, maxlength: 300, autocomplete: "off", spellcheck: "false", "aria-describedby": "v-hint" });
  const hint = h("p", { class: "quiet", id: "v-hint" });
  const go = h("button", { type: "submit", id: "v-connect" }, "Connect");
  let suggested = "";
  const suggestName = (): void => {
    if (name.value !== suggested || document.activeElement === name) return;
    name.value = suggested = freeName();
  };
  const choose = (): void => {
    const chosen = KINDS[kind.value];
    if (!chosen) return;
    url.value = chosen.address();
    fill(hint, chosen.hint);
  };
  kind.addEventListener("change", choose);
  choose();
  vehicles.watch(suggestName);
  const form = h(
    "form",
    { id: "connect" },
    h("div", { class: "field" }, h("label", { for: "v-kind" }, "How it is reached"), kind),
    h("div", { class: "field" }, h("label", { for: "v-url" }, "Address"), url),
    hint,
    h("div", { class: "field" }, h("label", { for: "v-name" }, "Name on this page"), name),
    h("div", { class: "row" }, go, button("Refresh the list", () => void attempt("The vehicles were not listed", refreshVehicles))),
  );
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    const wanted = { name: name.value.trim(), url: url.value.trim() };
    go.disabled = true;
    fill(go, "Connecting …");
    void attempt(`${wanted.name} was not connected`, () => connectVehicle(wanted.name, wanted.url))
      .then((vehicle) => {
        if (!vehicle) return;
        suggested = name.value;
        suggestName();
        if (!vehicle.connected && !vehicle.replay) warn(`${vehicle.name} is not heard yet`, `Nothing came in at ${vehicle.url}. It is listened for from now on; look at its power, its radio, address and port.`);
      })
      .finally(() => {
        go.disabled = false;
        fill(go, "Connect");
      });
  });
  return form;
}
