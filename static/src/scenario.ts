/** The scenario being edited: one GeoJSON document, its selection, its history. */
import type { Geometry } from "geojson";
import { canonical } from "./canonical";
import { boundsOf, type Bounds } from "./geo";
import { Signal } from "./signal";
import type { Member, Role, Scenario, ScenarioFeature } from "./types";

const HISTORY_DEPTH = 60;
const SINGLE: ReadonlySet<Role> = new Set(["area", "start", "end"]);

/** What a new scenario flies with until the operator says otherwise. */
export function emptyScenario(): Scenario {
  return {
    type: "FeatureCollection",
    name: "untitled",
    vehicles: [
      { name: "uav-1", type: "fixed_wing", autopilot: "ardupilot", airspeed_m_s: 20, min_turn_radius_m: 100, max_range_m: 60000 },
    ],
    sensors: [
      { name: "sar", type: "sar", incidence_deg: 45, elevation_beamwidth_deg: 30, azimuth_beamwidth_deg: 10, look: "right" },
    ],
    altitude_m: 500,
    altitude_reference: "terrain",
    seed: 0,
    features: [],
  };
}

export function nameOf(feature: ScenarioFeature): string {
  return String(feature.id ?? feature.properties.name ?? "");
}

/** The features by the names that their sensors have in the draft, which gets those it lacks. */
function mountedOn(draft: Scenario, features: ScenarioFeature[], sensors: Member[]): ScenarioFeature[] {
  // Where nothing was drawn yet, nobody has chosen the sensor and the altitude that are there.
  if (draft.features.length === 0) {
    draft.sensors = [];
    const altitude_m = features.find(({ properties }) => properties["altitude_m"] !== undefined)?.properties["altitude_m"];
    if (typeof altitude_m === "number") draft.altitude_m = altitude_m;
    else delete draft.altitude_m;
  }
  const named = new Map<unknown, string>();
  const mounted = (draft.sensors ??= []);
  for (const sensor of sensors) {
    const wanted = String(sensor["name"]);
    const same = mounted.find((other) => canonical({ ...other, name: "" }) === canonical({ ...sensor, name: "" }));
    let name = wanted;
    if (same) name = String(same["name"]);
    else {
      for (let i = 2; mounted.some((other) => other["name"] === name); i += 1) name = `${wanted} ${i}`;
      mounted.push({ ...sensor, name });
    }
    named.set(wanted, name);
  }
  return features.map((feature) => {
    const name = named.get(feature.properties["sensor"]);
    return name === undefined ? feature : { ...feature, properties: { ...feature.properties, sensor: name } };
  });
}

export function radiusOf(feature: ScenarioFeature): number {
  const radius = Number(feature.properties["radius_m"]);
  return feature.geometry.type === "Point" && radius > 0 ? radius : 0;
}

function prefix(role: Role, properties: Record<string, unknown>): string {
  if (role === "threat") return properties["model"] === "radar" ? "D" : "M";
  return { roi: "R", no_fly: "N", obstacle: "O", importance: "I", base: "B", area: "area", start: "start", end: "end" }[role];
}

/** Read a file's text as a scenario; throws with words an operator understands. */
export function parseScenario(text: string): Scenario {
  let value: unknown;
  try {
    value = JSON.parse(text);
  } catch (error) {
    throw new Error(`The file is not JSON: ${error instanceof Error ? error.message : String(error)}`);
  }
  const document = value as Partial<Scenario> | null;
  if (!document || document.type !== "FeatureCollection" || !Array.isArray(document.features)) {
    throw new Error("The file is not a GeoJSON FeatureCollection.");
  }
  document.features.forEach((feature, index) => {
    if (!feature || feature.type !== "Feature" || !feature.geometry || !feature.properties) {
      throw new Error(`Feature ${index + 1} lacks a geometry or properties.`);
    }
    if (typeof feature.properties.role !== "string") {
      throw new Error(`Feature ${String(feature.id ?? index + 1)} has no property "role": it is no scenario feature.`);
    }
  });
  return document as Scenario;
}

export class ScenarioStore {
  readonly document = new Signal<Scenario>(emptyScenario());
  readonly selection = new Signal<string | null>(null);
  /** Where the document comes from: edited here, or shown with a plan. */
  readonly edited = new Signal<boolean>(false);
  /** Counts the documents shown; one more with each that takes the place of another. */
  readonly replaced = new Signal<number>(0);
  #count = 0;
  readonly #past: string[] = [];
  readonly #future: string[] = [];

  /**
   * Show another document; with `edited` false it is the service's and need not be kept. Nothing of the one
   * before is left: not its history, and whoever watches `replaced` clears what belongs to it.
   */
  load(scenario: Scenario, edited: boolean): void {
    this.#past.length = 0;
    this.#future.length = 0;
    this.selection.set(null);
    this.#count += 1;
    this.replaced.set(this.#count);
    this.edited.set(edited);
    this.document.set(scenario);
  }

  change(alter: (draft: Scenario) => void): void {
    this.#remember();
    const draft = structuredClone(this.document.value);
    alter(draft);
    this.edited.set(true);
    this.document.set(draft);
  }

  undo(): void {
    this.#step(this.#past, this.#future);
  }

  redo(): void {
    this.#step(this.#future, this.#past);
  }

  find(name: string | null): ScenarioFeature | undefined {
    return name === null ? undefined : this.document.value.features.find((feature) => nameOf(feature) === name);
  }

  /** Add a feature under a free name; an area, start or end takes the place of the one there was. */
  add(role: Role, geometry: Geometry, properties: Record<string, unknown> = {}): string {
    const features = this.document.value.features;
    const stem = prefix(role, properties);
    const taken = new Set(features.map(nameOf));
    let name = SINGLE.has(role) ? stem : `${stem}1`;
    for (let i = 2; !SINGLE.has(role) && taken.has(name); i += 1) name = `${stem}${i}`;
    this.change((draft) => {
      if (SINGLE.has(role)) draft.features = draft.features.filter((feature) => feature.properties.role !== role);
      draft.features.push({ type: "Feature", id: name, properties: { role, name, ...properties }, geometry });
    });
    this.selection.set(name);
    return name;
  }

  /** Say what a shape is whose role an import could not know; a new area, start or end replaces the one there was. */
  settle(name: string, role: Role): void {
    this.change((draft) => {
      const feature = draft.features.find((one) => nameOf(one) === name);
      if (!feature) return;
      if (SINGLE.has(role)) draft.features = draft.features.filter((other) => other === feature || other.properties.role !== role);
      const { role_in_doubt: _, ...kept } = feature.properties;
      feature.properties = { ...kept, role };
    });
  }

  /**
   * Add features of a file under free names; a new area, start or end takes the place of the one there was. Of
   * two in the file both stay: the service says that there is one too many, where dropping one would not.
   */
  /** `sensors` are those that the features name; one of the same name and other figures keeps its own. */
  merge(added: ScenarioFeature[], sensors: Member[] = [], altitudeReference?: string): void {
    this.selection.set(null);
    this.change((draft) => {
      const features = sensors.length > 0 ? mountedOn(draft, added, sensors) : added;
      if (altitudeReference !== undefined) draft.altitude_reference = altitudeReference;
      const single = new Set(features.map((feature) => feature.properties.role).filter((role) => SINGLE.has(role)));
      draft.features = draft.features.filter((other) => !single.has(other.properties.role));
      for (const feature of features) {
        const taken = new Set(draft.features.map(nameOf));
        const wanted = nameOf(feature);
        let name = wanted;
        for (let i = 2; taken.has(name); i += 1) name = `${wanted} ${i}`;
        draft.features.push({ ...feature, id: name, properties: { ...feature.properties, name } });
      }
    });
  }

  reshape(name: string, geometry: Geometry, properties: Record<string, unknown> = {}): void {
    this.change((draft) => {
      const feature = draft.features.find((candidate) => nameOf(candidate) === name);
      if (!feature) return;
      feature.geometry = geometry;
      Object.assign(feature.properties, properties);
    });
  }

  /** Set a property, or take it away with undefined. */
  setProperty(name: string, property: string, value: unknown): void {
    this.change((draft) => {
      const feature = draft.features.find((candidate) => nameOf(candidate) === name);
      if (!feature) return;
      if (value === undefined) delete feature.properties[property];
      else feature.properties[property] = value;
    });
  }

  rename(name: string, next: string): boolean {
    if (next === "" || (next !== name && this.find(next))) return false;
    this.change((draft) => {
      const feature = draft.features.find((candidate) => nameOf(candidate) === name);
      if (!feature) return;
      feature.id = next;
      feature.properties.name = next;
    });
    this.selection.set(next);
    return true;
  }

  delete(name: string): void {
    this.selection.set(null);
    this.change((draft) => {
      draft.features = draft.features.filter((feature) => nameOf(feature) !== name);
    });
  }

  bounds(names?: string[]): Bounds | null {
    const features = this.document.value.features.filter((feature) => !names || names.includes(nameOf(feature)));
    return boundsOf(features.map((feature) => ({ geometry: feature.geometry, radius_m: radiusOf(feature) })));
  }

  /** The service has the document as it is now: there is nothing left to keep here. */
  handedOver(): void {
    this.edited.set(false);
  }

  text(): string {
    return `${JSON.stringify(this.document.value, null, 1)}\n`;
  }

  /** The document as it is compared with others. */
  canonical(): string {
    return canonical(this.document.value);
  }

  #remember(): void {
    this.#past.push(JSON.stringify(this.document.value));
    if (this.#past.length > HISTORY_DEPTH) this.#past.shift();
    this.#future.length = 0;
  }

  #step(from: string[], to: string[]): void {
    const text = from.pop();
    if (text === undefined) return;
    to.push(JSON.stringify(this.document.value));
    this.selection.set(null);
    this.edited.set(true);
    this.document.set(JSON.parse(text) as Scenario);
  }
}

export const scenarios = new ScenarioStore();
