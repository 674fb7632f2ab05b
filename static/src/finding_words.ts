/** Findings in the words of the page's forms: the service names properties as files do. */
import { labelOf } from "./panel/fields";
import type { Finding } from "./types";

/** What the ids of fields begin with, by what the service calls their owner. */
const OWNERS: readonly (readonly [prefix: string, RegExp])[] = [
  ["vehicles-0", /^vehicle /],
  ["sensors-0", /^sensor /],
  ["wind", /^wind$/],
  ["separation", /^separation$/],
  ["drift", /^drift$/],
  ["search", /^search$/],
];

/** By the last part of a property's name, longest first. */
const UNITS: readonly (readonly [ending: string, unit: string])[] = [
  ["_m_s", "m/s"], ["_m2", "m²"], ["_deg", "°"], ["_rad", "rad"], ["_wh", "Wh"], ["_kg", "kg"], ["_px", "px"], ["_mah", "mAh"], ["_m", "m"], ["_s", "s"], ["_w", "W"], ["_v", "V"],
];

/** A property's label with the unit that the file has it in, which its numbers in the text are of. */
function called(property: string, prefixes: readonly string[]): string | undefined {
  for (const prefix of prefixes) {
    const label = labelOf(`${prefix}-${property}`);
    if (label === undefined) continue;
    const unit = UNITS.find(([ending]) => property.endsWith(ending))?.[1];
    return unit === undefined ? `“${label}”` : `“${label}” (${unit})`;
  }
  return undefined;
}

/** A text of the service's with properties called as their fields are; those without a field keep their name. */
export function inFormWords(text: string, feature: string): string {
  const own = OWNERS.find(([, pattern]) => pattern.test(feature))?.[0] ?? (feature === "scenario" ? "s" : "f");
  // A finding of one thing may tell what to change at another.
  const prefixes = [own, ...["s", "f", "vehicles-0", "sensors-0"].filter((prefix) => prefix !== own)];
  return text.replace(/\b[a-z]+(?:_[a-z0-9]+)+\b/g, (word) => called(word, prefixes) ?? word);
}

/** What a finding is of, as the page calls it. */
export function ownerWords(feature: string): string {
  if (feature === "scenario") return "Scenario";
  if (feature === "request") return "Request";
  return feature.replace(/^vehicle (?=.)/, "Aircraft ").replace(/^sensor (?=.)/, "Sensor ").replace(/^(wind|separation|search|drift|method|objective)$/, (word) => (word[0] ?? "").toUpperCase() + word.slice(1));
}

export const messageOf = ({ message, feature }: Finding): string => inFormWords(message, feature);
/** What is done on the page where files are sent by hand, by rule. */
const DONE_HERE: Record<string, string> = {
  "unknown-terrain": "Open the raster's file here, or add it under “Ground”; without one the ground is flat at the height of home.",
  "no-start": "Place one with the tool “Start” over the map.",
};

export const fixOf = ({ fix, feature, rule }: Finding): string => DONE_HERE[rule] ?? inFormWords(fix, feature);
