/** The flying side of the panel: vehicles, upload, commands, live figures, flights. */
import { ask } from "../dialog";
import { button, fill, h, section } from "../dom";
import { command, connectVehicle, letGo, refreshVehicles, stream, vehicles, watched, watchVehicle, type Command } from "../fleet";
import { flights, flightUrl, flown, refly, refreshFlights, showFlight, type Flown } from "../flights";
import { open, openPlan } from "../plans";
import { attempt, news, warn } from "../notices";
import type { Vehicle } from "../types";
import { metres, number, percent } from "../units";
import { flightChart } from "./chart";
import { uploadBox } from "./upload_box";

const COMMANDS: { name: Command; label: string; says: string }[] = [
  { name: "arm", label: "Arm", says: "The motors may start." },
  { name: "start", label: "Start mission", says: "The aircraft takes off and flies the mission it holds." },
  { name: "pause", label: "Pause", says: "The aircraft leaves its line and waits in a circle." },
  { name: "resume", label: "Resume", says: "The aircraft goes on with the mission." },
  { name: "rtl", label: "Return", says: "The aircraft gives up the mission and returns to launch." },
  { name: "disarm", label: "Disarm", says: "The motors stop; an aircraft in flight refuses it." },
];
const TEXTS_SHOWN = 4;
const ERROR_SEVERITY = 3;
const FLIGHTS_SHOWN = 8;

function connectForm(): HTMLElement {
  const name = h("input", { id: "v-name", type: "text", required: true, placeholder: "uav-1", autocomplete: "off" });
  const url = h("input", { id: "v-url", type: "text", required: true, placeholder: "udpin:0.0.0.0:14550", autocomplete: "off", spellcheck: "false" });
  const go = h("button", { type: "submit" }, "Connect");
  const form = h(
    "form",
    {},
    h(
      "div",
      { class: "grid" },
      h("div", { class: "field" }, h("label", { for: "v-name" }, "Name"), name),
      h("div", { class: "field" }, h("label", { for: "v-url" }, "Address"), url),
    ),
    h("p", { class: "quiet" }, "udpin:host:port, udpout:host:port, tcp:host:port, serial:device:baud, sim: for a simulated aircraft, or replay:file for a recording"),
    h("div", { class: "row" }, go, button("Refresh the list", () => void attempt("The vehicles were not listed", refreshVehicles))),
  );
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    go.disabled = true;
    fill(go, "Connecting …");
    void attempt(`${name.value} was not connected`, () => connectVehicle(name.value.trim(), url.value.trim())).finally(() => {
      go.disabled = false;
      fill(go, "Connect");
    });
  });
  return form;
}

function vehicleList(): HTMLElement {
  const items = h("div", { role: "radiogroup", "aria-label": "Vehicles", id: "vehicles" });
  let shown = "";
  const draw = (): void => {
    const key = JSON.stringify([watched.value?.id, vehicles.value.map((vehicle) => [vehicle.id, vehicle.connected, vehicle.name, vehicle.link_failure])]);
    if (key === shown) return;
    shown = key;
    fill(
      items,
      ...vehicles.value.map((vehicle) =>
        h(
          "div",
          { class: "row" },
          h("input", { type: "radio", name: "vehicle", id: `v-${vehicle.id}`, checked: vehicle.id === watched.value?.id, onchange: () => watchVehicle(vehicle.id) }),
          h("label", { for: `v-${vehicle.id}` }, `${vehicle.name} – ${vehicle.url}${vehicle.connected ? "" : vehicle.link_failure ? " (no link)" : " (not heard)"}`),
          button("Let go", () => void release(vehicle), { class: "link", "aria-label": `Let ${vehicle.name} go` }),
        ),
      ),
      vehicles.value.length === 0 ? h("p", { class: "quiet" }, "No vehicle is connected.") : null,
    );
  };
  vehicles.watch(draw);
  watched.watch(draw);
  return h("div", {}, items, section("Connect a vehicle", false, connectForm()));
}

async function release(vehicle: Vehicle): Promise<void> {
  const flying = vehicle.state.armed ? ["It is armed. The link is closed; the aircraft itself gets no command."] : ["The link is closed; the vehicle gets no command."];
  const sure = await ask({ title: `Let ${vehicle.name} go?`, lines: flying, go: "Let go" });
  if (sure !== null) await attempt(`${vehicle.name} was not let go`, () => letGo(vehicle.id));
}

async function give(vehicle: Vehicle, wanted: (typeof COMMANDS)[number]): Promise<void> {
  const lines = [wanted.says];
  if (wanted.name === "start" && open.value && open.value.record.id !== vehicle.plan_id) lines.push("That is not known to be the plan on the map.");
  const sure = await ask({ title: `${wanted.label}: ${vehicle.name}?`, lines, go: wanted.label });
  if (sure === null) return;
  const answer = await attempt(`${wanted.label}: the command was not carried out`, () => command(vehicle.id, wanted.name));
  if (answer?.outcome === "unknown") warn(`${wanted.label}: ${vehicle.name} did not confirm it`, answer.detail);
  else if (answer) news(`${wanted.label}: ${vehicle.name} confirmed it.`);
}

function commands(): HTMLElement {
  const buttons = COMMANDS.map((wanted) => button(wanted.label, () => watched.value && void give(watched.value, wanted), { "data-command": wanted.name }));
  watched.watch((vehicle) => {
    const possible = vehicle !== null && vehicle.connected && !vehicle.replay;
    for (const made of buttons) made.disabled = !possible;
  });
  return h("div", { class: "row", role: "group", "aria-label": "Flight commands" }, ...buttons);
}

function gauges(): HTMLElement {
  const box = h("div", { id: "gauges" });
  const draw = (): void => {
    const vehicle = watched.value;
    if (!vehicle) return fill(box);
    const s = vehicle.state;
    const item = s.mission_current === null ? "–" : `${s.mission_current} / ${s.mission_total ?? "–"}`;
    const rows: [string, string, boolean?][] = [
      ["Mode", s.mode || "–"],
      ["Armed", s.armed ? "armed" : "no", s.armed],
      ["Sensor", s.sensor_on === null ? "–" : s.sensor_on ? "ON" : "off", s.sensor_on === true],
      ["Height", metres(s.relative_altitude_m)],
      ["Ground speed", number(s.ground_speed_m_s, 1, "m/s")],
      ["Heading", number(s.heading_deg, 0, "°")],
      ["Item", item],
      ["Battery", number(s.battery_percent, 0, "%")],
      ["GPS", s.gps_fix ?? "–"],
    ];
    const loud = s.texts.slice(-TEXTS_SHOWN).reverse();
    fill(
      box,
      vehicle.connected ? null : h("p", { class: "error" }, vehicle.link_failure ? `No link: ${vehicle.link_failure}; trying again …` : "The vehicle is not heard."),
      stream.value === "broken" ? h("p", { class: "error" }, "The telemetry is interrupted; trying again …") : null,
      vehicle.pending ? h("p", { class: "warning" }, "The last upload's outcome is unknown; it is read back when the vehicle is heard.") : null,
      h("dl", { class: "gauges" }, ...rows.map(([name, value, on]) => h("div", { class: on ? "gauge on" : "gauge" }, h("dt", {}, name), h("dd", { title: value }, value)))),
      loud.length > 0 ? h("ul", { class: "plain quiet" }, ...loud.map(({ severity, text }) => h("li", { class: severity <= ERROR_SEVERITY ? "error" : "" }, text))) : null,
    );
  };
  watched.watch(draw);
  stream.watch(draw);
  return box;
}

const SEEN = 0.9995;

function flownTable({ flight, seen }: Flown, planned: () => void): HTMLElement {
  const missing = Object.values(seen.coverage).some((fraction) => fraction < SEEN);
  const again = async (): Promise<void> => {
    const lines = ["A new scenario is made of what was not seen, and planned. It takes the place of the one on the page; Undo brings that back."];
    if ((await ask({ title: "Plan the gaps?", lines, go: "Plan the gaps" })) === null) return;
    const record = await attempt("The gaps were not planned", () => refly(flight.id));
    if (record && (await attempt("The plan of the gaps was not opened", () => openPlan(record.id)))) planned();
  };
  return h(
    "div",
    { class: "card", id: "flown" },
    h("p", {}, `Ground really seen by ${flight.vehicle_name}`),
    h(
      "table",
      {},
      h("thead", {}, h("tr", {}, h("th", {}, "Region"), h("td", {}, "seen"), h("td", {}, "planned"))),
      h(
        "tbody",
        {},
        ...Object.entries(seen.coverage).map(([roi, fraction]) =>
          h("tr", {}, h("th", { scope: "row" }, roi), h("td", {}, percent(fraction, 2)), h("td", {}, percent(seen.planned_coverage[roi], 2))),
        ),
      ),
    ),
    h(
      "div",
      { class: "row files" },
      button("Plan the gaps …", () => void again(), { id: "refly", class: missing ? "primary" : "", title: "Plan a flight over what was not seen" }),
      h("a", { href: flightUrl(flight.id, "report.html"), target: "_blank", rel: "noopener" }, "Report"),
      h("a", { href: flightUrl(flight.id, "track.gpx"), download: `${flight.vehicle_name}.gpx` }, "Track (GPX)"),
      h("a", { href: flightUrl(flight.id, "coverage.geojson"), download: `${flight.vehicle_name}-coverage.geojson` }, "Coverage (GeoJSON)"),
    ),
    h("p", { class: "quiet" }, `Furthest from the line while the sensor was on: ${number(Math.max(0, ...seen.collects.map((c) => c.cross_track_max_m)), 1, "m")}`),
  );
}

function flightList(planned: () => void): HTMLElement {
  const items = h("ul", { class: "plain", id: "flights" });
  const shown = h("div", {});
  flights.watch((all) =>
    fill(
      items,
      ...all.slice(0, FLIGHTS_SHOWN).map((flight) =>
        h(
          "li",
          {},
          button(`${flight.vehicle_name} · ${flight.state}`, () => void attempt("What the flight saw cannot be shown", () => showFlight(flight)), { class: "link" }),
          h("span", { class: "quiet" }, ` ${new Date(flight.started_at).toLocaleString()}`),
        ),
      ),
      all.length === 0 ? h("li", { class: "quiet" }, "None yet.") : null,
    ),
  );
  flown.watch((result) => fill(shown, result ? flownTable(result, planned) : null));
  return section("Flights", true, shown, items, button("Refresh", () => void attempt("The flights were not listed", refreshFlights)));
}

/** `planned` is called when a plan of a flight's gaps is on the map. */
export function vehiclePanel(planned: () => void): HTMLElement {
  const title = h("h2", {});
  watched.watch((vehicle) => fill(title, vehicle ? vehicle.name : "No vehicle"));
  return h("div", {}, vehicleList(), title, commands(), gauges(), uploadBox(), flightChart(), flightList(planned));
}
