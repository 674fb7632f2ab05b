/** The aircraft on the map: its symbol, its track, the ground it has really seen. */
import { Marker, type Map as MapLibreMap } from "maplibre-gl";
import { h } from "./dom";
import { vehicles, watched } from "./fleet";
import { flown, recordedTrack } from "./flights";
import { ageWords, hearing, OLD_S } from "./hearing";
import { setData } from "./map";
import { attempt } from "./notices";
import { Track } from "./track";
import { scenarios } from "./scenario";
import type { Position, Vehicle } from "./types";

const SVG = "http://www.w3.org/2000/svg";
/** Four rotors on two arms. */
const ROTORS = [[8, 8], [26, 8], [8, 26], [26, 26]].map(([x, y]) => `M${(x as number) - 6.500} ${y} a6.500 6.500 0 1 0 13 0 a6.500 6.500 0 1 0 -13 0z`).join("");
const ARMS = "M7 9.500 9.500 7 27 24.500 24.500 27z M24.500 7 27 9.500 9.500 27 7 24.500z M17 1 20.500 9h-7z";
const SHAPE = "M17 1.500 19.500 12 33 20v3.500L19.500 20l-.8 8 4.300 3v2L17 31.500 11 33v-2l4.300-3-.8-8L1 23.500V20l13.500-8z";

function symbol(other?: string): HTMLElement {
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("viewBox", "0 0 34 34");
  const path = document.createElementNS(SVG, "path");
  for (const [name, value] of Object.entries({ d: SHAPE, fill: "#ffd400", stroke: "#1a1a1a", "stroke-width": "1.4" })) {
    path.setAttribute(name, value);
  }
  svg.append(path);
  const element = h("div", { class: other === undefined ? "aircraft" : "other-aircraft", role: "img", "aria-label": other ?? "Aircraft", title: other });
  element.append(svg);
  return element;
}

const TICK_MS = 1000;

/** A place that is old is drawn as such, and says how old it is. */
function tellAge(element: HTMLElement, vehicle: Vehicle): void {
  const heard = hearing(vehicle);
  const old = heard.lost || (heard.age_s !== null && heard.age_s > OLD_S);
  element.classList.toggle("old", old);
  element.dataset["age"] = old ? `${vehicle.name}: ${heard.lost ? "link lost, " : ""}here ${ageWords(heard)} ago` : "";
}

/** The other vehicles, fainter and by name, as the list last told. */
function showOthers(map: MapLibreMap): void {
  const markers = new Map<string, Marker>();
  const draw = (): void => {
    const others = vehicles.value.filter(({ id, state }) => id !== watched.value?.id && state.lon_deg !== null && state.lat_deg !== null);
    for (const [id, marker] of markers) {
      if (others.some((vehicle) => vehicle.id === id)) continue;
      marker.remove();
      markers.delete(id);
    }
    for (const vehicle of others) {
      const { id, name, state } = vehicle;
      const known = markers.get(id);
      const marker = known ?? new Marker({ element: symbol(name), rotationAlignment: "map" });
      marker.setLngLat([state.lon_deg as number, state.lat_deg as number]);
      turn(marker, state.heading_deg);
      shapeLike(marker, state.type);
      tellAge(marker.getElement(), vehicle);
      if (known) continue;
      markers.set(id, marker);
      marker.addTo(map);
    }
  };
  vehicles.watch(draw);
  let shown: string | null = null;
  watched.watch((vehicle) => {
    if ((vehicle?.id ?? null) === shown) return;
    shown = vehicle?.id ?? null;
    draw();
  });
}

const HOVERS = /rotor|copter|quad|hexa|octo/i;

/** What hovers is drawn as such. */
function shapeLike(marker: Marker, type: string): void {
  const path = marker.getElement().querySelector("path");
  const shape = HOVERS.test(type) && !/vtol/i.test(type) ? ROTORS + ARMS : SHAPE;
  if (path && path.getAttribute("d") !== shape) path.setAttribute("d", shape);
}

/** The symbol alone turns; the words beside it stay upright. */
function turn(marker: Marker, heading_deg: number | null): void {
  const svg = marker.getElement().querySelector("svg");
  if (svg) svg.style.transform = `rotate(${heading_deg ?? 0}deg)`;
}

/** The live track of the flight going on; a flight shown afterwards brings its own. */
export const track = new Track();

export function showAircraft(map: MapLibreMap): void {
  showOthers(map);
  const marker = new Marker({ element: symbol(), rotationAlignment: "map" });
  let shownId: string | null = null;
  let followedId: string | null = null;
  let flightId: string | null = null;
  const flownSoFar = async (id: string): Promise<void> => {
    const recorded = await attempt("The track flown so far was not read", () => recordedTrack(id));
    if (!recorded || flightId !== id) return;
    track.precede(recorded);
    setData(map, "track", track.features());
  };
  watched.watch((vehicle) => {
    const state = vehicle?.state;
    if (!vehicle || !state || state.lon_deg === null || state.lat_deg === null) {
      marker.remove();
      shownId = null;
      return;
    }
    const at: Position = [state.lon_deg, state.lat_deg];
    marker.setLngLat(at);
    turn(marker, state.heading_deg);
    shapeLike(marker, state.type);
    tellAge(marker.getElement(), vehicle);
    if (shownId === null) marker.addTo(map);
    shownId = vehicle.id;
    const another = followedId !== vehicle.id;
    const first = followedId === null;
    followedId = vehicle.id;
    const begun = vehicle.flight_id !== null && vehicle.flight_id !== flightId;
    if ((another && !first) || begun) {
      track.clear();
      setData(map, "track", []);
    }
    // A flight that was going on before this page looked has a part that only the service saw.
    if (begun && another) void flownSoFar(vehicle.flight_id as string);
    flightId = vehicle.flight_id;
    if (flightId !== null && track.add({ at, sensor_on: state.sensor_on === true, time_s: state.time_s })) setData(map, "track", track.features());
  });
  setInterval(() => {
    if (watched.value) tellAge(marker.getElement(), watched.value);
  }, TICK_MS);
  // A track of a flight that is over belongs to the scenario that was on the page.
  scenarios.replaced.watch(() => {
    if (flightId !== null) return;
    track.clear();
    setData(map, "track", []);
  });
  flown.watch((shown) => {
    setData(map, "seen", shown?.seen.features ?? []);
    if (shown) setData(map, "track", shown.track);
  });
}
