/** What the page's scenario has that the one of a plan in flight had not: the body that asks for a plan of what is left. */
import { canonical } from "./canonical";
import { nameOf } from "./scenario";
import type { Scenario, ScenarioFeature } from "./types";

export interface Differences {
  add: ScenarioFeature[];
  /** Of `add` those that take the place of what had the same name. */
  changed: string[];
  remove: string[];
  wind: unknown;
  /** What the page has changed and a flight under way cannot take over: members of the collection, shapes without a name. */
  refused: string[];
}

export interface Replan {
  add: ScenarioFeature[];
  remove: string[];
  lost: string[];
  at_s?: number;
  wind?: unknown;
}

const TAKEN = new Set(["features", "wind", "name", "type"]);
const VEHICLES = "vehicles";

export function differences(before: Scenario, now: Scenario): Differences {
  const old = new Map(before.features.map((feature) => [nameOf(feature), canonical(feature)]));
  const names = new Set(now.features.map(nameOf));
  const other = now.features.filter((feature) => old.get(nameOf(feature)) !== canonical(feature));
  const known = new Set(before.features.map(canonical));
  const nameless = other.filter((feature) => nameOf(feature) === "" && !known.has(canonical(feature)));
  const add = other.filter((feature) => nameOf(feature) !== "");
  const members = [...new Set([...Object.keys(before), ...Object.keys(now)])].filter((key) => !TAKEN.has(key) && canonical(before[key]) !== canonical(now[key]));
  // No wind said is none, which has to be said once there was one.
  const wind = canonical(before["wind"]) === canonical(now["wind"]) ? undefined : (now["wind"] ?? { speed_m_s: 0, from_deg: 0 });
  return {
    add,
    changed: add.map(nameOf).filter((name) => old.has(name)),
    remove: [...old.keys()].filter((name) => name !== "" && !names.has(name)),
    wind,
    refused: [...members.map((key) => (key === VEHICLES ? "aircraft" : key)), ...nameless.map(() => "a shape without a name")],
  };
}

/** In words, an entry each; empty where nothing is other. */
export function wordsOf({ add, changed, remove, wind }: Differences): string[] {
  const fresh = add.map(nameOf).filter((name) => !changed.includes(name));
  const entry = (word: string, names: string[]): string[] => (names.length > 0 ? [`${word}: ${names.join(", ")}`] : []);
  return [...entry("new", fresh), ...entry("changed", changed), ...entry("gone", remove), ...(wind === undefined ? [] : ["the wind"])];
}
