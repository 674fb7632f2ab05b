/** The watched vehicle in figures, what stands in its way, and what it says. */
import { ask } from "../dialog";
import { button, fill, h } from "../dom";
import { acknowledge, acknowledgeAddress, stream, watched } from "../fleet";
import { distance_m } from "../geo";
import { attempt } from "../notices";
import type { Vehicle } from "../types";
import { metres, number } from "../units";

const TEXTS_SHOWN = 4;
const ERROR_SEVERITY = 3;
const TITLES: Record<string, string> = { Height: "Over home", "From home": "Over ground, to where it would return to", Sensor: "As the output that switches it is reported" };
const AUTOPILOTS: Record<string, string> = { ardupilot: "ArduPilot", px4: "PX4" };

function figures({ state: s }: Vehicle): [string, string, boolean?][] {
  const home = s.home_lon_deg !== null && s.home_lat_deg !== null && s.lon_deg !== null && s.lat_deg !== null
    ? distance_m([s.lon_deg, s.lat_deg], [s.home_lon_deg, s.home_lat_deg])
    : null;
  return [
    ["Mode", s.mode || "–"],
    ["Armed", s.armed ? "ARMED" : "no", s.armed],
    ["Sensor", s.sensor_on === null ? "–" : s.sensor_on ? "ON" : "off", s.sensor_on === true],
    ["Height", metres(s.relative_altitude_m)],
    ["Ground speed", number(s.ground_speed_m_s, 1, "m/s")],
    ["Airspeed", number(s.airspeed_m_s, 1, "m/s")],
    ["Mission item", s.mission_current === null ? "–" : s.mission_total === null ? String(s.mission_current) : `${s.mission_current} of ${s.mission_total - 1}`],
    ["From home", metres(home)],
    ["Heading", number(s.heading_deg, 0, "°")],
    ["Battery", number(s.battery_percent, 0, "%")],
    ["Voltage", number(s.battery_voltage_v, 1, "V")],
    ["GPS", s.satellites === null ? (s.gps_fix ?? "–") : `${s.gps_fix ?? "–"} · ${s.satellites} sat.`],
  ];
}

/** What kind of vehicle it says it is. */
export function kindOf({ connected, state }: Vehicle): string {
  return connected ? [AUTOPILOTS[state.autopilot] ?? "unknown autopilot", state.type.replaceAll("_", " ")].join(", ") : "";
}

export function gauges(): HTMLElement {
  const box = h("div", { id: "gauges" });
  watched.watch((vehicle) => {
    fill(
      box,
      vehicle
        ? h("dl", { class: "gauges" }, ...figures(vehicle).map(([name, value, on]) => h("div", { class: on ? "gauge on" : "gauge" }, h("dt", {}, name), h("dd", { title: TITLES[name] ?? value }, value))))
        : null,
    );
  });
  return box;
}

async function take(vehicle: Vehicle, systemId: number): Promise<void> {
  const lines = ["Its mission is not known: neither the plan of the aircraft before it nor that one's upload count for it.", "Let the vehicle go instead, and connect it under a name of its own, to keep both apart."];
  const sure = await ask({ title: `Is system ${systemId} ${vehicle.name} from now on?`, lines, go: "Acknowledge" });
  if (sure !== null) await attempt("The other aircraft was not acknowledged", () => acknowledge(vehicle.id, systemId));
}

/** Why the vehicle is not connected, and what can be done about it. */
function absence(vehicle: Vehicle): HTMLElement | null {
  if (vehicle.connected) return null;
  const other = vehicle.other_system;
  if (other !== null) {
    const says = `Another aircraft, system ${other}, answers where ${vehicle.name}, system ${vehicle.system_id ?? "unknown"}, did. It gets no order and no mission until it is acknowledged. `;
    return h("p", { class: "error" }, says, button("Acknowledge …", () => void take(vehicle, other)));
  }
  const signed = vehicle.signing === null ? undefined : SIGNING[vehicle.signing];
  if (signed !== undefined) return h("p", { class: "error" }, signed);
  return h("p", { class: "error" }, vehicle.link_failure ? `No link: ${vehicle.link_failure}; trying again …` : `The vehicle is not heard at ${vehicle.url}; it is listened for.`);
}

/** Addresses offered at a time: more speak only where somebody plays tricks. */
const ADDRESSES_SHOWN = 4;

async function takeAddress(vehicle: Vehicle, address: string): Promise<void> {
  const lines = ["Whoever speaks from elsewhere is not heard.", address === vehicle.address ? "It is heard from there already." : "It is another address than before: nothing is known of what the aircraft there holds."];
  const sure = await ask({ title: `Is ${vehicle.name} at ${address}?`, lines, go: "Acknowledge" });
  if (sure !== null) await attempt("The address was not acknowledged", () => acknowledgeAddress(vehicle.id, address));
}

/** Why it is not certain who hears its orders, and what can be done about it. */
function doubt(vehicle: Vehicle): HTMLElement | null {
  if (vehicle.doubt === null) return null;
  const says = `${vehicle.doubt.message}. Only stops are sent: ${vehicle.doubt.fix}. `;
  const places = vehicle.strangers.length === 0 ? [] : [...(vehicle.address === null ? [] : [vehicle.address]), ...vehicle.strangers].slice(0, ADDRESSES_SHOWN);
  return h("p", { class: "error" }, says, ...places.map((place) => button(`It is at ${place} …`, () => void takeAddress(vehicle, place))));
}

/** Others that say that they are the same system, each on its own link. */
function namesakes(vehicle: Vehicle): HTMLElement | null {
  if (vehicle.namesakes.length === 0) return null;
  return h("p", { class: "warning" }, `${vehicle.namesakes.join(", ")} says that it is system ${vehicle.system_id ?? "unknown"}, too, on a link of its own: orders from here reach ${vehicle.name} alone, other ground stations take the two for one. Give one of them another system id.`);
}

/** Why a vehicle that is heard does not count as there. */
const SIGNING: Record<string, string> = {
  unsigned: "It is heard, but does not sign, and with its key given nothing unsigned counts.",
  wrong_key: "It is heard, but signs with another key than the one given.",
  replayed: "It is heard, and signs with the right key and a time long past.",
};

/** Warnings and the vehicle's own words; they stand under the controls, so that these never move. */
export function words(): HTMLElement {
  const box = h("div", { id: "words" });
  const draw = (): void => {
    const vehicle = watched.value;
    if (!vehicle) return fill(box);
    const loud = vehicle.state.texts.slice(-TEXTS_SHOWN).reverse();
    fill(
      box,
      absence(vehicle),
      doubt(vehicle),
      namesakes(vehicle),
      stream.value === "broken" ? h("p", { class: "error" }, "The telemetry is interrupted; trying again …") : null,
      vehicle.pending ? h("p", { class: "warning" }, "The last upload's outcome is unknown; it is read back when the vehicle is heard.") : null,
      loud.length > 0 ? h("ul", { class: "plain quiet", "aria-label": "What the vehicle says" }, ...loud.map(({ severity, text }) => h("li", { class: severity <= ERROR_SEVERITY ? "error" : "" }, text))) : null,
    );
  };
  watched.watch(draw);
  stream.watch(draw);
  return box;
}
