/** Forms for what belongs to the whole scenario: aircraft, sensors, altitude, methods, weights. */
import { h, section } from "../dom";
import { scenarios } from "../scenario";
import type { Member, Scenario } from "../types";
import { choiceField, numberField, tickField, type Field } from "./fields";
import { aircraftKey, aircraftSections } from "./aircraft_form";
import { nested, top } from "./members";
import { sensorSections, sensorsKey } from "./sensor_form";
import { importanceField, terrainField } from "./raster_field";

const METHODS: Record<string, readonly string[]> = {
  coverage: ["auto", "li2018", "majeed2019", "boustrophedon-cells", "coverage-alternatives"],
  routing: ["auto", "joint", "li2018", "li2018-threat-aware", "stecz2020"],
  search: [
    "auto", "parallel", "creeping", "spiral", "square", "sector", "refined", "importance", "snyder2021",
    "energy-horizon", "energy-horizon-discrete", "energy-horizon-no-decision", "energy-horizon-time",
  ],
  transit: ["auto", "ssas", "tangent", "milp", "milp-length"],
  smoothing: ["auto", "fillet", "shortcut", "three-arc", "past-target", "short-turn"],
};
const WEIGHTS = ["length", "missile", "radar", "energy", "turns"] as const;

function mission(): Field[] {
  const altitude = top("altitude_m");
  const following = top("terrain_following");
  const lowest = top("min_height_m");
  const highest = top("max_height_m");
  const reference = top("altitude_reference");
  const seed = top("seed");
  const budget = top("time_budget_s");
  const clearance = top("clearance_m");
  const task = top("task");
  return [
    choiceField({
      id: "s-task", label: "What is to be done", get: () => task.get<string>() ?? "collect", set: (value) => task.set(value === "collect" ? undefined : value),
      choices: [["collect", "see every region"], ["search", "search: as much as the energy allows"]],
    }),
    numberField({ id: "s-altitude_m", label: "Altitude", unit: "m", min: 0, placeholder: "by the quality wanted", hint: "Left empty, regions are flown over as high as what they ask for allows", get: () => altitude.get<number>(), set: altitude.set }),
    choiceField({
      id: "s-altitude_reference", label: "Altitude over", get: () => reference.get<string>(), set: reference.set,
      choices: [["terrain", "terrain"], ["home", "home"], ["amsl", "mean sea level"]],
    }),
    numberField({ id: "s-min_height_m", label: "Least height", unit: "m", min: 0, placeholder: "10", hint: "Over the ground; heights chosen by the quality wanted are not lower. Over terrain the clearance where left empty", get: () => lowest.get<number>(), set: lowest.set }),
    numberField({ id: "s-max_height_m", label: "Greatest height", unit: "m", min: 0, placeholder: "the altitude", hint: "Over the ground; heights chosen by the quality wanted are not greater", get: () => highest.get<number>(), set: highest.set }),
    terrainField(),
    tickField({ id: "s-terrain_following", label: "Follow the ground", hint: "Passes of cameras keep their height over the raster's ground", get: () => following.get<boolean>() ?? false, set: (value) => following.set(value ? true : undefined) }),
    numberField({ id: "s-clearance_m", label: "Clearance", unit: "m", min: 0, placeholder: "the autopilot's", hint: "Kept from zones, hard threats, obstacles and terrain", get: () => clearance.get<number>(), set: clearance.set }),
    ...wind(),
    ...lookedFor(),
    ...apart(),
    numberField({ id: "s-seed", label: "Seed", min: 0, placeholder: "0", get: () => seed.get<number>(), set: seed.set }),
    numberField({ id: "s-time_budget_s", label: "Time for planning", unit: "s", min: 0, placeholder: "no limit", get: () => budget.get<number>(), set: budget.set }),
  ];
}

/** What aircraft of one plan keep between them. */
function apart(): Field[] {
  if ((scenarios.document.value.vehicles?.length ?? 0) < 2) return [];
  const get = (property: string) => () => (scenarios.document.value["separation"] as Member | undefined)?.[property] as number | undefined;
  const set = (property: string) => (value: unknown): void =>
    scenarios.change((draft) => {
      const target: Member = { ...(draft["separation"] as Member | undefined), [property]: value };
      for (const key of Object.keys(target)) if (target[key] === undefined) delete target[key];
      if (Object.keys(target).length === 0) delete draft["separation"];
      else draft["separation"] = target;
    });
  return [
    numberField({ id: "separation-horizontal_m", label: "Apart, sideways", unit: "m", min: 0, placeholder: "100", hint: "Aircraft keep this distance, or the one in height, at every instant", get: get("horizontal_m"), set: set("horizontal_m") }),
    numberField({ id: "separation-vertical_m", label: "Apart, in height", unit: "m", min: 0, placeholder: "30", get: get("vertical_m"), set: set("vertical_m") }),
  ];
}

/** A search has its own stage in place of those that cover and order regions. */
function methods(): Field[] {
  const searched = scenarios.document.value["task"] === "search";
  return Object.entries(METHODS).filter(([stage]) => (stage === "search" || stage === "coverage" || stage === "routing" ? (stage === "search") === searched : true)).map(([stage, choices]) => {
    const { get, set } = nested("method", stage);
    return choiceField({
      id: `m-${stage}`, label: stage[0]?.toUpperCase() + stage.slice(1), choices,
      get: () => get<string>() ?? "auto", set: (value) => set(value === "auto" ? undefined : value),
    });
  });
}

function wind(): Field[] {
  const get = (property: string) => () => (scenarios.document.value["wind"] as Member | undefined)?.[property] as number | undefined;
  const set = (property: string, value: unknown): void =>
    scenarios.change((draft) => {
      const target: Member = { from_deg: 0, ...(draft["wind"] as Member | undefined), [property]: value };
      if (target["speed_m_s"] === undefined) delete draft["wind"];
      else draft["wind"] = { ...target, from_deg: target["from_deg"] ?? 0 };
    });
  return [
    numberField({ id: "wind-speed_m_s", label: "Wind speed", unit: "m/s", min: 0, max: 100, placeholder: "still air", get: get("speed_m_s"), set: (value) => set("speed_m_s", value) }),
    numberField({ id: "wind-from_deg", label: "Wind from", unit: "°", min: 0, max: 360, placeholder: "0", hint: "Clockwise from north; needs a speed", get: get("from_deg"), set: (value) => set("from_deg", value) }),
  ];
}

/** What a search is told of what it looks for. */
function lookedFor(): Field[] {
  if (scenarios.document.value["task"] !== "search") return [];
  const search = (): Member => (scenarios.document.value["search"] as Member | undefined) ?? {};
  const drift = (): Member => (search()["drift"] as Member | undefined) ?? {};
  const put = (member: Member): void =>
    scenarios.change((draft) => {
      const kept = Object.fromEntries(Object.entries(member).filter(([, value]) => value !== undefined));
      if (Object.keys(kept).length > 0) draft["search"] = kept;
      else delete draft["search"];
    });
  const moved = (property: string) => (value: unknown): void => {
    const wanted: Member = { toward_deg: 0, ...drift(), [property]: value };
    const kept = Object.fromEntries(Object.entries(wanted).filter(([, each]) => each !== undefined));
    put({ ...search(), drift: kept["speed_m_s"] === undefined ? undefined : { ...kept, toward_deg: kept["toward_deg"] ?? 0 } });
  };
  const driftField = (property: string, label: string, unit: string, placeholder: string, hint: string, max?: number): Field =>
    numberField({ id: `drift-${property}`, label, unit, min: 0, ...(max === undefined ? {} : { max }), placeholder, hint, get: () => drift()[property] as number | undefined, set: moved(property) });
  return [
    importanceField(),
    numberField({ id: "search-detection", label: "Found by a look", min: 0, max: 1, placeholder: "1", hint: "Probability that a look finds what it sees", get: () => search()["detection"] as number | undefined, set: (value) => put({ ...search(), detection: value }) }),
    driftField("speed_m_s", "Drift", "m/s", "stays", "How fast what is looked for moves on"),
    driftField("toward_deg", "Drift toward", "°", "0", "Clockwise from north; needs a drift", 360),
    driftField("spread_m_s", "Drift uncertain by", "m/s", "0", "One standard deviation, in each direction; needs a drift"),
    driftField("elapsed_s", "Since last seen", "s", "0", "From when it was where importance says until take-off; needs a drift"),
  ];
}

function weights(): Field[] {
  return WEIGHTS.map((weight) => {
    const { get, set } = nested("objective", weight);
    return numberField({
      id: `w-${weight}`, label: weight[0]?.toUpperCase() + weight.slice(1), min: 0,
      placeholder: weight === "energy" || weight === "turns" ? "0" : "1", get: () => get<number>(), set,
    });
  });
}

/** What decides which fields there are. */
export function settingsKey(scenario: Scenario): string {
  return `${aircraftKey()}|${sensorsKey(scenario.sensors ?? [])}|${String(scenario["task"] ?? "")}`;
}

export function settingsForm(): Field {
  const fields: Field[] = [];
  const plain = (field: Field): HTMLElement => {
    fields.push(field);
    return field.element;
  };
  const grid = (made: Field[]): HTMLElement => h("div", { class: "grid" }, ...made.map(plain));
  const element = h(
    "div",
    {},
    section("Altitude, ground and wind", true, grid(mission())),
    ...sensorSections(grid, plain),
    ...aircraftSections(grid),
    section("Methods", false, grid(methods())),
    section("Weights", false, grid(weights())),
  );
  return { element, sync: () => fields.forEach((field) => field.sync()) };
}
