/** Forms for what belongs to the whole scenario: aircraft, sensors, altitude, methods, weights. */
import { h, section } from "../dom";
import { scenarios } from "../scenario";
import type { Member, Scenario } from "../types";
import { choiceField, numberField, textField, type Field } from "./fields";

type List = "vehicles" | "sensors";

const METHODS: Record<string, readonly string[]> = {
  coverage: ["auto", "li2018"],
  routing: ["auto", "joint", "li2018", "li2018-threat-aware"],
  transit: ["auto", "ssas", "tangent"],
  smoothing: ["auto", "fillet", "shortcut"],
};
const WEIGHTS = ["length", "missile", "radar", "energy", "turns"] as const;

/** Read and write one property of the nth vehicle or sensor; undefined takes it away. */
function member(list: List, index: number, property: string) {
  return {
    get: <T>() => scenarios.document.value[list]?.[index]?.[property] as T | undefined,
    set: (value: unknown): void =>
      scenarios.change((draft) => {
        const target = draft[list]?.[index];
        if (!target) return;
        if (value === undefined) delete target[property];
        else target[property] = value;
      }),
  };
}

function nested(group: "method" | "objective", property: string) {
  return {
    get: <T>() => (scenarios.document.value[group] as Member | undefined)?.[property] as T | undefined,
    set: (value: unknown): void =>
      scenarios.change((draft) => {
        const target: Member = { ...(draft[group] as Member | undefined) };
        if (value === undefined) delete target[property];
        else target[property] = value;
        if (Object.keys(target).length === 0) delete draft[group];
        else (draft as Member)[group] = target;
      }),
  };
}

function top(property: keyof Scenario) {
  return {
    get: <T>() => scenarios.document.value[property] as T | undefined,
    set: (value: unknown): void =>
      scenarios.change((draft) => {
        if (value === undefined) delete draft[property];
        else draft[property] = value;
      }),
  };
}

function number(list: List, index: number, property: string, label: string, unit: string, extra: object = {}): Field {
  const { get, set } = member(list, index, property);
  return numberField({ id: `${list}-${index}-${property}`, label, unit, min: 0, get: () => get<number>(), set, ...extra });
}

function choice(list: List, index: number, property: string, label: string, choices: readonly string[]): Field {
  const { get, set } = member(list, index, property);
  return choiceField({ id: `${list}-${index}-${property}`, label, choices, get: () => get<string>(), set });
}

function name(list: List, index: number): Field {
  const { get, set } = member(list, index, "name");
  return textField({
    id: `${list}-${index}-name`, label: "Name", get: () => get<string>(), set,
    refuse: (text) => (text === "" ? "A name is needed." : ""),
  });
}

function vehicle(index: number): Field[] {
  return [
    name("vehicles", index),
    choice("vehicles", index, "autopilot", "Autopilot", ["ardupilot", "px4"]),
    number("vehicles", index, "airspeed_m_s", "Airspeed", "m/s", { required: true }),
    number("vehicles", index, "min_turn_radius_m", "Least turn radius", "m"),
    number("vehicles", index, "max_bank_deg", "Greatest bank", "°", { max: 89 }),
    number("vehicles", index, "max_climb_deg", "Greatest climb", "°", { max: 89 }),
    number("vehicles", index, "max_range_m", "Range", "m"),
    number("vehicles", index, "max_flight_time_s", "Flight time", "s"),
    number("vehicles", index, "energy_wh", "Energy", "Wh"),
    number("vehicles", index, "cruise_power_w", "Cruise power", "W"),
    number("vehicles", index, "settle_m", "Settle before a collect", "m"),
  ];
}

function sensor(index: number): Field[] {
  return [
    name("sensors", index),
    choice("sensors", index, "look", "Looks", ["right", "left", "both"]),
    number("sensors", index, "incidence_deg", "Incidence", "°", { max: 90 }),
    number("sensors", index, "elevation_beamwidth_deg", "Beam, elevation", "°", { max: 180 }),
    number("sensors", index, "azimuth_beamwidth_deg", "Beam, azimuth", "°", { max: 180 }),
    number("sensors", index, "aperture_length_m", "Aperture length", "m"),
    number("sensors", index, "wavelength_m", "Wavelength", "m"),
    number("sensors", index, "resolution_m", "Resolution", "m"),
  ];
}

function mission(): Field[] {
  const altitude = top("altitude_m");
  const reference = top("altitude_reference");
  const seed = top("seed");
  const budget = top("time_budget_s");
  return [
    numberField({ id: "s-altitude_m", label: "Altitude", unit: "m", min: 0, required: true, get: () => altitude.get<number>(), set: altitude.set }),
    choiceField({
      id: "s-altitude_reference", label: "Altitude over", get: () => reference.get<string>(), set: reference.set,
      choices: [["terrain", "terrain"], ["home", "home"], ["amsl", "mean sea level"]],
    }),
    numberField({ id: "s-seed", label: "Seed", min: 0, placeholder: "0", get: () => seed.get<number>(), set: seed.set }),
    numberField({ id: "s-time_budget_s", label: "Time for planning", unit: "s", min: 0, placeholder: "no limit", get: () => budget.get<number>(), set: budget.set }),
  ];
}

function methods(): Field[] {
  return Object.entries(METHODS).map(([stage, choices]) => {
    const { get, set } = nested("method", stage);
    return choiceField({
      id: `m-${stage}`, label: stage[0]?.toUpperCase() + stage.slice(1), choices,
      get: () => get<string>() ?? "auto", set: (value) => set(value === "auto" ? undefined : value),
    });
  });
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
  return `${scenario.vehicles?.length ?? 0}|${scenario.sensors?.length ?? 0}`;
}

export function settingsForm(scenario: Scenario): Field {
  const fields: Field[] = [];
  const grid = (made: Field[]): HTMLElement => {
    fields.push(...made);
    return h("div", { class: "grid" }, ...made.map((field) => field.element));
  };
  const numbered = (word: string, count: number, index: number): string => (count > 1 ? `${word} ${index + 1}` : word);
  const vehicles = scenario.vehicles ?? [];
  const sensors = scenario.sensors ?? [];
  const element = h(
    "div",
    {},
    section("Altitude and planning", true, grid(mission())),
    ...vehicles.map((_, index) => section(numbered("Aircraft", vehicles.length, index), false, grid(vehicle(index)))),
    ...sensors.map((_, index) => section(numbered("Sensor", sensors.length, index), false, grid(sensor(index)))),
    section("Methods", false, grid(methods())),
    section("Weights", false, grid(weights())),
  );
  return { element, sync: () => fields.forEach((field) => field.sync()) };
}
