/** Forms for what belongs to the whole scenario: aircraft, sensors, altitude, methods, weights. */
import { button, h, section } from "../dom";
import { scenarios } from "../scenario";
import type { Member, Scenario } from "../types";
import { choiceField, numberField, textField, tickField, type Field } from "./fields";
import { terrainField } from "./terrain_field";

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

/** A choice whose first entry is what holds when nothing is said. */
function choice(list: List, index: number, property: string, label: string, choices: readonly (string | readonly [string, string])[]): Field {
  const { get, set } = member(list, index, property);
  const first = choices[0] as string | readonly [string, string];
  const usual = typeof first === "string" ? first : first[0];
  return choiceField({ id: `${list}-${index}-${property}`, label, choices, get: () => get<string>() ?? usual, set });
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
    choice("vehicles", index, "type", "Type", [["fixed_wing", "fixed wing"], "multirotor", ["vtol", "VTOL"]]),
    choice("vehicles", index, "autopilot", "Autopilot", [["ardupilot", "ArduPilot"], ["px4", "PX4"]]),
    finish(index),
    number("vehicles", index, "airspeed_m_s", "Airspeed", "m/s", { required: true }),
    number("vehicles", index, "settle_m", "Straight before a pass", "m", { placeholder: "its autopilot's", hint: "Straight flight wanted before each pass, so that the aircraft is on its line when the sensor goes on; left empty, as many seconds of it as the autopilot needs: 10 for ArduPlane" }),
    number("vehicles", index, "min_turn_radius_m", "Least turn radius", "m", { hint: "The widest of turn radius, bank and load factor counts" }),
    number("vehicles", index, "max_bank_deg", "Greatest bank", "°", { max: 84.9 }),
    number("vehicles", index, "max_load_factor", "Greatest load factor", "g", { min: 1 }),
    number("vehicles", index, "max_climb_deg", "Greatest climb", "°", { max: 89, placeholder: "8" }),
    number("vehicles", index, "max_range_m", "Range", "m", { placeholder: "no limit" }),
    number("vehicles", index, "max_flight_time_s", "Flight time", "s", { placeholder: "no limit" }),
    number("vehicles", index, "energy_wh", "Energy", "Wh", { placeholder: "no limit", hint: "Needs the cruise power" }),
    number("vehicles", index, "cruise_power_w", "Cruise power", "W"),
  ];
}

/** Planned with the flight, as its landing or return is part of it. */
function finish(index: number): Field {
  const { get, set } = member("vehicles", index, "finish");
  const choices = [["auto", "return near home, else land"], ["land", "land at the end"], ["return", "return to launch"], ["loiter", "circle at the end"]] as const;
  return choiceField({ id: `vehicles-${index}-finish`, label: "How its mission ends", choices, get: () => get<string>() ?? "auto", set: (value) => set(value === "auto" ? undefined : value) });
}

function steered(index: number): Field {
  const { get, set } = member("sensors", index, "stabilised");
  return tickField({
    id: `sensors-${index}-stabilised`, label: "Steered abeam of the course", hint: "In wind an antenna fixed to the aircraft turns with the nose; a steered one does not",
    get: () => get<boolean>() ?? false, set: (value) => set(value ? true : undefined),
  });
}

function sensor(index: number): Field[] {
  return [
    name("sensors", index),
    choice("sensors", index, "look", "Looks", ["right", "left", "both"]),
    choice("sensors", index, "mode", "Mode", ["stripmap", "spotlight", ["scansar", "ScanSAR"]]),
    number("sensors", index, "incidence_deg", "Incidence", "°", { max: 90, required: true }),
    number("sensors", index, "elevation_beamwidth_deg", "Beam, elevation", "°", { max: 180, required: true }),
    number("sensors", index, "azimuth_beamwidth_deg", "Beam, azimuth", "°", { max: 180, placeholder: "from the aperture" }),
    number("sensors", index, "aperture_length_m", "Aperture length", "m"),
    number("sensors", index, "wavelength_m", "Wavelength", "m"),
    number("sensors", index, "resolution_m", "Resolution", "m"),
    number("sensors", index, "squint_deg", "Squint", "°", { min: -60, max: 60, placeholder: "0", hint: "Forward is positive" }),
    ...(scenarios.document.value.sensors?.[index]?.["mode"] === "scansar"
      ? [number("sensors", index, "sub_swaths", "Sub-swaths", "", { min: 1, placeholder: "3" })]
      : []),
    steered(index),
    number("sensors", index, "pointing_margin_deg", "Pointing margin", "°", { max: 15, placeholder: "its autopilot's", hint: "Planned with this much less of the beam at every edge, because the aircraft sways; left empty, what its autopilot needs: 1.5° to 3°" }),
    number("sensors", index, "position_margin_m", "Position margin", "m", { placeholder: "its autopilot's", hint: "Planned with this much less of the swath at every edge, because the aircraft is not quite on its line; left empty, what its autopilot needs: 2 to 5 m" }),
  ];
}

function mission(): Field[] {
  const altitude = top("altitude_m");
  const reference = top("altitude_reference");
  const seed = top("seed");
  const budget = top("time_budget_s");
  const clearance = top("clearance_m");
  return [
    numberField({ id: "s-altitude_m", label: "Altitude", unit: "m", min: 0, required: true, get: () => altitude.get<number>(), set: altitude.set }),
    choiceField({
      id: "s-altitude_reference", label: "Altitude over", get: () => reference.get<string>(), set: reference.set,
      choices: [["terrain", "terrain"], ["home", "home"], ["amsl", "mean sea level"]],
    }),
    terrainField(),
    numberField({ id: "s-clearance_m", label: "Clearance", unit: "m", min: 0, placeholder: "the autopilot's", hint: "Kept from zones, hard threats, obstacles and terrain", get: () => clearance.get<number>(), set: clearance.set }),
    ...wind(),
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

/** One more sensor, a copy of the last; and the nth taken away. */
function addSensor(): void {
  scenarios.change((draft) => {
    const sensors = draft.sensors ?? [];
    const taken = new Set(sensors.map((each) => String(each["name"])));
    let number = sensors.length + 1;
    while (taken.has(`sar-${number}`)) number += 1;
    draft.sensors = [...sensors, { ...structuredClone(sensors.at(-1) ?? { type: "sar" }), name: `sar-${number}` }];
  });
}

function removeSensor(index: number): void {
  scenarios.change((draft) => void draft.sensors?.splice(index, 1));
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
  return `${scenario.vehicles?.length ?? 0}|${(scenario.sensors ?? []).map((sensor) => sensor["mode"] === "scansar").join()}`;
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
    section("Altitude, ground and wind", true, grid(mission())),
    ...vehicles.map((_, index) => section(numbered("Aircraft", vehicles.length, index), false, grid(vehicle(index)))),
    ...sensors.map((_, index) =>
      section(
        numbered("Sensor", sensors.length, index),
        false,
        grid(sensor(index)),
        h(
          "div",
          { class: "row" },
          index === sensors.length - 1 ? button("Add a sensor", addSensor) : null,
          sensors.length > 1 ? button("Remove", () => removeSensor(index), { class: "danger", "aria-label": `Remove sensor ${index + 1}` }) : null,
        ),
      ),
    ),
    section("Methods", false, grid(methods())),
    section("Weights", false, grid(weights())),
  );
  return { element, sync: () => fields.forEach((field) => field.sync()) };
}
