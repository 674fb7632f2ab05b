/** The aircraft that fly: what each can do, where it starts, what it carries; more of them added and taken away. */
import { button, h, section } from "../dom";
import { news } from "../notices";
import { nameOf, scenarios } from "../scenario";
import type { Member } from "../types";
import { goToField } from "./field_findings";
import { choiceField, textField, type Field } from "./fields";
import { choice, member, name, number } from "./members";

type Kind = "fixed_wing" | "multirotor" | "vtol";
const KINDS = [["fixed_wing", "fixed wing"], ["multirotor", "multirotor"], ["vtol", "VTOL"]] as const;

/** What an aircraft of each kind flies like where nobody has said otherwise. */
const USUAL: Record<Kind, Member> = {
  fixed_wing: { airspeed_m_s: 20, min_turn_radius_m: 100, max_range_m: 60_000 },
  multirotor: { airspeed_m_s: 10, max_range_m: 12_000 },
  vtol: { airspeed_m_s: 20, min_turn_radius_m: 100, max_range_m: 60_000 },
};

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
  return choiceField({ id: `vehicles-${index}-type`, label: "Type", choices: KINDS, get: () => get<string>() ?? "fixed_wing", set: (value) => turnInto(index, value as Kind) });
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

function fields(index: number): Field[] {
  return [
    name("vehicles", index),
    typeField(index),
    choice("vehicles", index, "autopilot", "Autopilot", [["ardupilot", "ArduPilot"], ["px4", "PX4"]]),
    ...base(index),
    ...carried(index),
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
    number("vehicles", index, "batteries", "Batteries", "", { min: 1, placeholder: "1", hint: "Work beyond one battery is split into so many flights at the most" }),
    number("vehicles", index, "turnaround_s", "Between two flights", "s", { placeholder: "0", hint: "From landing to the next take-off" }),
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
  return [vehicles.length, sensors.map((sensor) => String(sensor["name"])).join(","), basesOf().join(",")].join("|");
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
