/** A line for each vehicle, in every tab: what stands edited, planned, uploaded and flying; link, mode, battery, sensor. */
import { connection } from "../api";
import { byId, fill, h } from "../dom";
import { stream, vehicles, watched, watchVehicle } from "../fleet";
import { freshness } from "../freshness";
import { ageWords, hearing, OLD_S, STALE_S, type Hearing } from "../hearing";
import { stepsOf, type Step, type Tone } from "../holding";
import { keeping } from "../keeping";
import { coming, open, recent, running } from "../plans";
import { scenarios } from "../scenario";
import type { Vehicle } from "../types";
import { number } from "../units";

const TICK_MS = 500;
const LOW_BATTERY = 25;
const EMPTY_BATTERY = 15;

type Cell = [label: string, words: string, tone: Tone, more: string];

const stepCell = ({ label, words, tone, more }: Step): Cell => [label, words, tone, more];

function sensorCell({ sensor, state }: Vehicle): Cell {
  const on = sensor ? sensor.on : state.sensor_on;
  const since = sensor?.since_s == null ? "" : `, for ${Math.round(sensor.since_s)} s`;
  return ["Sensor", on === null ? "not told" : on ? "ON" : "off", on ? "on" as Tone : on === null ? "warning" : "", `As the output that switches it is reported${since}`];
}

function ageTone({ age_s }: Hearing): Tone {
  return age_s === null ? "quiet" : age_s > STALE_S ? "error" : age_s > OLD_S ? "warning" : "";
}

/** Figures of a vehicle that is not heard now were true once: they stand behind a mark. */
function told(vehicle: Vehicle, heard: Hearing): Cell[] {
  const { state } = vehicle;
  const was = heard.lost ? "was " : "";
  const battery = state.battery_percent;
  return [
    ["Link", heard.words, heard.tone, heard.lost ? `Nothing was heard of it since; where it was then is on the map` : "How much of what it sends comes in"],
    ["Position", ageWords(heard), ageTone(heard), "How old the place on the map is"],
    ["Mode", `${was}${state.mode || "–"}`, heard.lost ? "error" : "", "As the autopilot names it"],
    ["Armed", `${was}${state.armed ? "ARMED" : "disarmed"}`, state.armed ? "warning" : heard.lost ? "error" : "", state.armed ? "Its motors may turn" : ""],
    ["Height", `${was}${number(state.relative_altitude_m, 0, "m")}`, heard.lost ? "error" : "", "Over home"],
    ["Battery", `${was}${number(battery, 0, "%")}`, battery === null ? "quiet" : battery < EMPTY_BATTERY ? "error" : battery < LOW_BATTERY ? "warning" : "", "As the autopilot tells it"],
    sensorCell(vehicle),
  ];
}

function emptyCell(): HTMLElement {
  return h("div", {}, h("span", { class: "label" }), h("span", { class: "value" }));
}

/** Change only what differs: an element under the pointer, or with the focus, stays. */
function show(element: HTMLElement, [label, words, tone, more]: Cell): void {
  const [name, value] = element.children as unknown as [HTMLElement, HTMLElement];
  if (name.textContent !== label) name.textContent = label;
  if (value.textContent !== words) value.textContent = words;
  element.className = `cell ${tone}`;
  element.title = `${label}: ${words}. ${more}`;
  element.dataset["cell"] = label.toLowerCase();
}

const STEPS = 4;
const TOLD = 7;

class Row {
  readonly element: HTMLElement;
  readonly #who: HTMLButtonElement;
  readonly #steps: HTMLElement[];
  readonly #told: HTMLElement[];

  constructor(id: string | null) {
    this.#who = h("button", { type: "button", class: "who", disabled: id === null, onclick: () => watchVehicle(id) });
    this.#steps = Array.from({ length: id === null ? 2 : STEPS }, emptyCell);
    this.#told = Array.from({ length: id === null ? 0 : TOLD }, emptyCell);
    const chain = this.#steps.flatMap((step, index) => [index > 0 ? h("span", { class: "then", "aria-hidden": "true" }, "›") : null, step]);
    this.element = h("div", { role: "group" }, this.#who, h("div", { class: "steps" }, ...chain), h("div", { class: "told" }, ...this.#told));
  }

  update(vehicle: Vehicle | null, heard: Hearing | null): void {
    const name = vehicle?.name ?? "No vehicle";
    const now = vehicle !== null && vehicle.id === watched.value?.id;
    if (this.#who.textContent !== name) this.#who.textContent = name;
    this.#who.setAttribute("aria-pressed", String(now));
    this.#who.title = vehicle === null ? "Connect one under Fly" : now ? `${name} is watched` : `Watch ${name}`;
    this.element.className = `vrow${heard?.lost ? " lost" : ""}${now ? " now" : ""}`;
    this.element.setAttribute("aria-label", `Status of ${name}`);
    if (vehicle) this.element.dataset["vehicle"] = name;
    stepsOf(vehicle).forEach((step, index) => show(this.#steps[index]!, stepCell(step)));
    if (vehicle && heard) told(vehicle, heard).forEach((cell, index) => show(this.#told[index]!, cell));
  }
}

/** As the watched one last told by its own stream, the others as the list did. */
function present(): Vehicle[] {
  return vehicles.value.map((vehicle) => (vehicle.id === watched.value?.id && stream.value === "open" ? watched.value : vehicle));
}

export function buildStatusStrip(): void {
  const box = byId("strip");
  const alarm = byId("alarm");
  const rows = new Map<string, Row>();
  const none = new Row(null);
  let alarmed = "";
  const draw = (): void => {
    const all = present();
    const heard = all.map((vehicle) => hearing(vehicle));
    for (const vehicle of all) if (!rows.has(vehicle.id)) rows.set(vehicle.id, new Row(vehicle.id));
    for (const id of rows.keys()) if (!all.some((vehicle) => vehicle.id === id)) rows.delete(id);
    all.forEach((vehicle, index) => rows.get(vehicle.id)!.update(vehicle, heard[index]!));
    if (all.length === 0) none.update(null, null);
    const wanted = all.length > 0 ? [...rows.values()].map(({ element }) => element) : [none.element];
    if (wanted.length !== box.children.length || wanted.some((element, index) => box.children[index] !== element)) fill(box, ...wanted);
    const lost = all.filter((_, index) => heard[index]?.lost);
    const words = [
      connection.value === "down" ? "The service is not reachable: nothing here is up to date, and no command gets through." : "",
      lost.length > 0 ? `LINK LOST: ${lost.map((vehicle) => `${vehicle.name}${vehicle.state.armed ? " (armed when last heard)" : ""}`).join(", ")}. The place on the map is where it was last heard.` : "",
    ].filter(Boolean).join(" ");
    if (words === alarmed) return;
    alarmed = words;
    alarm.hidden = words === "";
    fill(alarm, words);
    document.title = words ? `⚠ ${lost.length > 0 ? "Link lost" : "Service lost"} – Swathplan` : "Swathplan";
  };
  for (const signal of [vehicles, watched, stream, connection, freshness, keeping, coming, open, recent, running, scenarios.document]) (signal as { watch(listener: () => void): unknown }).watch(draw);
  setInterval(draw, TICK_MS);
}
