/** The aircraft that fly: what each can do, where it starts, what it carries; more of them added and taken away. */
import { airframe, airframes, completed, type Airframe } from "../airframes";
import { button, h, section } from "../dom";
import { news } from "../notices";
import { nameOf, scenarios } from "../scenario";
import type { Member } from "../types";
import { goToField } from "./field_findings";
import { choiceField, suggestField, textField, type Field } from "./fields";
import { choice, member, name, number } from "./members";

type Kind = "fixed_wing" | "multirotor" | "vtol";
const KINDS = [["fixed_wing", "fixed wing"], ["multirotor", "multirotor"], ["vtol", "VTOL"]] as const;

/** What an aircraft of each kind flies like where nobody has said otherwise. */
const USUAL: Record<Kind, Member> = {
  fixed_wing: { airspeed_m_s: 20, min_turn_radius_m: 100, max_range_m: 60_000 },
  multirotor: { airspeed_m_s: 10, max_range_m: 12_000 },
  vtol: { airspeed_m_s: 20, min_turn_radius_m: 100, max_range_m: 60_000 },
};

/** The usual figures, unless somebody has given others; what the airframe tells is left to it. */
function leaveTo(vehicle: Member, told: Member): void {
  const usual = USUAL[(vehicle["type"] as Kind | undefined) ?? "fixed_wing"];
  for (const [property, value] of Object.entries(usual)) if (vehicle[property] === value) delete vehicle[property];
  for (const property of Object.keys(told)) delete vehicle[property];
  // Energy and range are two ways to say how far it comes.
  if (told["energy_wh"] !== undefined || told["power"] !== undefined) delete vehicle["cruise_power_w"];
}

/** An aircraft of a known airframe flies by its figures; of none any more, by its kind's usual ones where it has none. */
function setModel(index: number, called: string | undefined): void {
  scenarios.change((draft) => {
    const vehicle = draft.vehicles?.[index];
    if (!vehicle) return;
    const kind = (completed(vehicle)["type"] as Kind | undefined) ?? "fixed_wing";
    const known = airframe(called);
    if (known) {
      leaveTo(vehicle, known.vehicle);
      vehicle["model"] = known.name;
      return;
    }
    delete vehicle["model"];
    const turns = vehicle["max_bank_deg"] ?? vehicle["max_load_factor"];
    for (const [property, value] of Object.entries({ type: kind, ...USUAL[kind] })) if (vehicle[property] === undefined && !(property === "min_turn_radius_m" && turns !== undefined)) vehicle[property] = value;
  });
}

function modelField(index: number): Field {
  const { get } = member("vehicles", index, "model");
  const figures = ({ vehicle }: Airframe): string =>
    [(KINDS.find(([kind]) => kind === vehicle["type"]) ?? ["", ""])[1], `${String(vehicle["airspeed_m_s"])} m/s`, vehicle["energy_wh"] === undefined ? "" : `${String(vehicle["energy_wh"])} Wh`].filter(Boolean).join(", ");
  return suggestField({
    id: `vehicles-${index}-model`, label: "Airframe", placeholder: "by its figures below", wide: true,
    hint: "From the service's database of published figures; what is given below goes before them",
    suggestions: airframes, words: figures, get: () => get<string>(), set: (called) => setModel(index, called),
    refuse: (text) => (text === "" || airframe(text) || airframes.value.length === 0 ? "" : `The database has no airframe of this name; it has: ${airframes.value.map(({ name: called }) => called).join(", ")}. Or leave this empty and give its figures.`),
  });
}

/** Another kind flies by its own figures; those that somebody chose stay. */
function turnInto(index: number, kind: Kind): void {
  scenarios.change((draft) => {
    const vehicle = draft.vehicles?.[index];
    if (!vehicle) return;
    const before = USUAL[(vehicle["type"] as Kind | undefined) ?? "fixed_wing"];
    vehicle["type"] = kind;
    const changed: string[] = [];
    for (const property of new Set([...Object.keys(before), ...Object.keys(USUAL[kind])])) {
      if (vehicle[property] !== before[property] || before[property] === USUAL[kind][property]) continue;
      changed.push(property);
      if (USUAL[kind][property] === undefined) delete vehicle[property];
      else vehicle[property] = USUAL[kind][property];
    }
    if (changed.length > 0) news(`${String(vehicle["name"])} flies by a ${kind.replace("_", " ")}'s usual figures now: see its speed, turns and range.`);
  });
}

function typeField(index: number): Field {
  const { get } = member("vehicles", index, "type");
  const usual = (): string => (airframe(scenarios.document.value.vehicles?.[index]?.["model"])?.vehicle["type"] as string | undefined) ?? "fixed_wing";
  return choiceField({ id: `vehicles-${index}-type`, label: "Type", choices: KINDS, get: () => get<string>() ?? usual(), set: (value) => turnInto(index, value as Kind) });
}

/** Planned with the flight, as its landing or return is part of it. */
function finish(index: number): Field {
  const { get, set } = member("vehicles", index, "finish");
  const choices = [["auto", "return near home, else land"], ["land", "land at the end"], ["return", "return to launch"], ["loiter", "circle at the end"]] as const;
  return choiceField({ id: `vehicles-${index}-finish`, label: "How its mission ends", choices, get: () => get<string>() ?? "auto", set: (value) => set(value === "auto" ? undefined : value) });
}

const basesOf = (): string[] => scenarios.document.value.features.filter(({ properties }) => properties.role === "base").map((base) => String(base.properties.name ?? nameOf(base)));

function base(index: number): Field[] {
  const names = basesOf();
  const { get, set } = member("vehicles", index, "base");
  if (names.length === 0 && get() === undefined) return [];
  return [choiceField({ id: `vehicles-${index}-base`, label: "Starts from", choices: [["", "the start"], ...names.map((one) => [one, one] as const)], get: () => get<string>() ?? "", set: (value) => set(value || undefined) })];
}

const listed = (text: string): string[] => text.split(",").map((part) => part.trim()).filter((part) => part !== "");

function carried(index: number): Field[] {
  const sensors = (scenarios.document.value.sensors ?? []).map((sensor) => String(sensor["name"]));
  if (sensors.length < 2) return [];
  const { get, set } = member("vehicles", index, "sensors");
  return [
    textField({
      id: `vehicles-${index}-sensors`, label: "Sensors on board", placeholder: "all", hint: `Separated by commas, of: ${sensors.join(", ")}`,
      get: () => get<string[]>()?.join(", "),
      set: (text) => set(text === undefined ? undefined : listed(text)),
      refuse: (text) => {
        const unknown = listed(text).find((one) => !sensors.includes(one));
        return unknown === undefined ? "" : `There is no sensor ${unknown}; there are: ${sensors.join(", ")}.`;
      },
    }),
  ];
}

function endBases(index: number): Field[] {
  const names = basesOf();
  const { get, set } = member("vehicles", index, "end_bases");
  if (names.length === 0 && get() === undefined) return [];
  return [
    textField({
      id: `vehicles-${index}-end_bases`, label: "Lands at one of", placeholder: "where it starts", hint: `Names of bases, separated by commas, of: ${names.join(", ")}; the one that suits the whole flight is taken; the next battery starts there`,
      get: () => get<string[]>()?.join(", "),
      set: (text) => set(text === undefined ? undefined : listed(text)),
      refuse: (text) => {
        const unknown = listed(text).find((one) => !names.includes(one));
        return unknown === undefined ? "" : `There is no base ${unknown}; there are: ${names.join(", ")}.`;
      },
    }),
  ];
}

function fields(index: number): Field[] {
  const told = airframe(scenarios.document.value.vehicles?.[index]?.["model"])?.vehicle ?? {};
  // What the airframe tells stands in the empty field.
  const figure = (property: string, otherwise?: string): { placeholder?: string } => {
    const value = told[property];
    const placeholder = typeof value === "number" ? String(value) : otherwise;
    return placeholder === undefined ? {} : { placeholder };
  };
  return [
    name("vehicles", index),
    modelField(index),
    typeField(index),
    choice("vehicles", index, "autopilot", "Autopilot", [["ardupilot", "ArduPilot"], ["px4", "PX4"]]),
    ...base(index),
    ...endBases(index),
    ...carried(index),
    finish(index),
    number("vehicles", index, "airspeed_m_s", "Airspeed", "m/s", { required: told["airspeed_m_s"] === undefined, ...figure("airspeed_m_s") }),
    number("vehicles", index, "min_airspeed_m_s", "Least airspeed", "m/s", { placeholder: "its airspeed", hint: "Passes are flown as slowly as this where photos would come too soon" }),
    number("vehicles", index, "settle_m", "Straight before a pass", "m", { placeholder: "its autopilot's", hint: "Straight flight wanted before each pass, so that the aircraft is on its line when the sensor goes on; left empty, as many seconds of it as the autopilot needs: 10 for ArduPlane" }),
    number("vehicles", index, "min_turn_radius_m", "Least turn radius", "m", { hint: "The widest of turn radius, bank and load factor counts" }),
    number("vehicles", index, "max_bank_deg", "Greatest bank", "°", { max: 84.9, ...figure("max_bank_deg") }),
    number("vehicles", index, "max_load_factor", "Greatest load factor", "g", { min: 1 }),
    number("vehicles", index, "max_climb_deg", "Greatest climb", "°", { max: 89, placeholder: "8" }),
    number("vehicles", index, "max_range_m", "Range", "m", { placeholder: "no limit" }),
    number("vehicles", index, "max_flight_time_s", "Flight time", "s", { placeholder: "no limit" }),
    number("vehicles", index, "energy_wh", "Energy", "Wh", { ...figure("energy_wh", "no limit"), hint: "Needs the cruise power, or an airframe whose power is known" }),
    number("vehicles", index, "cruise_power_w", "Cruise power", "W", told["power"] === undefined ? {} : { placeholder: "the airframe's" }),
    number("vehicles", index, "reserve", "Kept in reserve", "%", { scale: 100, max: 99.9, placeholder: "20", hint: "Part of the energy that is left at landing" }),
    number("vehicles", index, "batteries", "Batteries", "", { min: 1, placeholder: "1", hint: "Work beyond one battery is split into so many flights at the most" }),
    number("vehicles", index, "turnaround_s", "Between two flights", "s", { placeholder: "0", hint: "From landing to the next take-off" }),
    number("vehicles", index, "max_items", "Mission items at most", "", { min: 20, placeholder: "its autopilot's", hint: "Where its autopilot takes fewer than usual; work beyond them is split into flights" }),
  ];
}

function add(): void {
  scenarios.change((draft) => {
    const vehicles = draft.vehicles ?? [];
    const taken = new Set(vehicles.map((vehicle) => String(vehicle["name"])));
    let [called, count] = ["uav-1", 1];
    while (taken.has(called)) called = `uav-${(count += 1)}`;
    const like = vehicles.at(-1) ?? { type: "fixed_wing", autopilot: "ardupilot", ...USUAL.fixed_wing };
    draft.vehicles = [...vehicles, { ...structuredClone(like), name: called }];
  });
  const first = document.getElementById(`vehicles-${(scenarios.document.value.vehicles?.length ?? 1) - 1}-name`);
  if (first) goToField(first);
}

const gone = (index: number): void => scenarios.change((draft) => void draft.vehicles?.splice(index, 1));

/** What decides which fields there are. */
export function aircraftKey(): string {
  const { vehicles = [], sensors = [] } = scenarios.document.value;
  return [vehicles.map((vehicle) => String(airframe(vehicle["model"])?.name ?? "")).join(","), sensors.map((sensor) => String(sensor["name"])).join(","), basesOf().join(",")].join("|");
}

export function aircraftSections(grid: (made: Field[]) => HTMLElement): HTMLElement[] {
  const count = scenarios.document.value.vehicles?.length ?? 0;
  const parts = Array.from({ length: count }, (_, index) =>
    section(
      count > 1 ? `Aircraft ${index + 1}` : "Aircraft",
      false,
      grid(fields(index)),
      count > 1 ? h("div", { class: "row" }, button("Take this aircraft away", () => gone(index), { class: "danger" })) : null,
    ),
  );
  return [...parts, h("div", { class: "row" }, button("Add an aircraft", add, { id: "add-aircraft", title: "Like the last one, under another name" }))];
}
