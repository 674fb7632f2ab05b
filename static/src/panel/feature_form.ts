/** The form of the selected feature: its name, what its role allows, and its coordinates. */
import type { Geometry } from "geojson";
import { button, fill, h } from "../dom";
import { ROLE_WORDS } from "../role_words";
import { rolesFor } from "../roles";
import { nameOf, scenarios } from "../scenario";
import type { Role, ScenarioFeature } from "../types";
import { findingWords } from "../notices";
import { sizeWords } from "../size";
import { judgement } from "../validation";
import { fieldOf } from "./field_findings";
import { areaField, choiceField, numberField, textField, tickField, type Field } from "./fields";
import { scaled } from "./members";

/** Corners as lines of "longitude, latitude"; only for a point, a line, or a polygon of one ring. */
function coordinateText(geometry: Geometry): string | null {
  const line = (position: number[]): string => position.slice(0, 2).join(", ");
  if (geometry.type === "Point") return line(geometry.coordinates);
  if (geometry.type === "LineString") return geometry.coordinates.map(line).join("\n");
  if (geometry.type === "Polygon" && geometry.coordinates.length === 1) return (geometry.coordinates[0] ?? []).slice(0, -1).map(line).join("\n");
  return null;
}

function readCoordinates(text: string): number[][] {
  return text
    .split("\n")
    .map((line) => line.trim())
    .filter((line) => line !== "")
    .map((line) => line.split(/[\s,;]+/).map(Number));
}

function refuseCoordinates(type: string, text: string): string {
  const found = readCoordinates(text);
  const wanted = { Point: 1, LineString: 2, Polygon: 3 }[type] ?? 1;
  if (found.length < wanted || (type === "Point" && found.length > 1)) return `Write ${type === "Point" ? "one line" : `at least ${wanted} lines`}: longitude, latitude.`;
  const wrong = found.findIndex((p) => p.length !== 2 || !p.every(Number.isFinite) || Math.abs(p[0] as number) > 180 || Math.abs(p[1] as number) > 90);
  return wrong < 0 ? "" : `Line ${wrong + 1} is no longitude (±180) and latitude (±90).`;
}

function asGeometry(type: string, text: string): Geometry {
  const found = readCoordinates(text);
  if (type === "Point") return { type: "Point", coordinates: found[0] as number[] };
  if (type === "LineString") return { type: "LineString", coordinates: found };
  return { type: "Polygon", coordinates: [[...found, found[0] as number[]]] };
}

function headings(text: string): number[] {
  return text.split(/[\s,;]+/).filter((part) => part !== "").map(Number);
}

/** What decides which fields there are; the form is built anew when it changes. */
export function formKey(feature: ScenarioFeature | undefined): string {
  if (!feature) return "";
  const sensors = feature.properties.role === "roi" ? (scenarios.document.value.sensors ?? []).map((sensor) => `${String(sensor["name"])} ${String(sensor["type"])}`) : [];
  return [...sensors, nameOf(feature), feature.properties.role, feature.geometry.type, String(feature.properties["model"]), String(feature.properties["role_in_doubt"])].join("|");
}

function roleFields(name: string, role: string, geometryType: string, model: unknown): Field[] {
  const get = <T>(property: string) => () => scenarios.find(name)?.properties[property] as T | undefined;
  const set = (property: string) => (value: unknown) => scenarios.setProperty(name, property, value);
  const number = (property: string, label: string, unit: string, extra: object = {}): Field =>
    numberField({ id: `f-${property}`, label, unit, get: get<number>(property), set: set(property), ...extra });
  const sensors = (scenarios.document.value.sensors ?? []).map((sensor) => String(sensor["name"]));
  switch (role) {
    case "roi":
      return [
        numberField({ id: "f-priority", label: "Priority", min: 0, placeholder: "1", get: get<number>("priority"), set: set("priority") }),
        tickField({
          id: "f-required", label: "Required", get: () => (get<boolean>("required")() ?? true),
          set: (value) => scenarios.setProperty(name, "required", value ? undefined : false),
        }),
        textField({
          id: "f-approach_deg", label: "Allowed headings (°)", placeholder: "any", hint: "Clockwise from north, separated by commas",
          get: () => get<number[]>("approach_deg")()?.join(", "),
          set: (text) => scenarios.setProperty(name, "approach_deg", text === undefined ? undefined : headings(text)),
          refuse: (text) => (headings(text).every((v) => v >= 0 && v <= 360) ? "" : "Headings from 0 to 360, separated by commas."),
        }),
        ...(sensors.length > 1
          ? [choiceField({ id: "f-sensor", label: "Sensor", choices: [["", "the first"], ...sensors.map((s) => [s, s] as const)], get: get<string>("sensor"), set: (v) => scenarios.setProperty(name, "sensor", v || undefined) })]
          : []),
        numberField({
          id: "f-gsd_m", label: "A pixel at most", unit: "cm", min: 0, placeholder: "any", hint: "Ground sampled distance: what the worst pixel may cover; it decides the height",
          ...scaled({ get: <T>() => scenarios.find(name)?.properties["gsd_m"] as T | undefined, set: set("gsd_m") }, 100),
        }),
        number("min_niirs", "NIIRS at least", "", { min: 0, max: 9, placeholder: "any", hint: "Needs the sensor's edge response and signal to noise" }),
        number("min_resolution_m", "Resolution wanted", "m", { min: 0, placeholder: "any" }),
        number("altitude_m", "Altitude", "m", { min: 0, placeholder: "the flight's" }),
        number("revisits", "Times to be seen", "", { min: 1, max: 50, placeholder: "1" }),
        number("revisit_after_s", "Apart by at least", "s", { min: 0, placeholder: "0", hint: "Between two times that it is seen" }),
        textField({
          id: "f-time_window_s", label: "May be seen between (s)", placeholder: "any time", hint: "Two numbers of seconds after the mission's start, separated by a comma",
          get: () => get<number[]>("time_window_s")()?.join(", "),
          set: (text) => scenarios.setProperty(name, "time_window_s", text === undefined ? undefined : headings(text)),
          refuse: (text) => {
            const found = headings(text);
            if (found.length !== 2 || !found.every((value) => value >= 0)) return "Two numbers of seconds, separated by a comma.";
            return (found[0] as number) < (found[1] as number) ? "" : "It has to open before it closes.";
          },
        }),
        ...((scenarios.document.value.sensors ?? []).some((sensor) => sensor["type"] === "camera")
          ? [
              choiceField({
                id: "f-pattern", label: "Flown as", get: () => get<string>("pattern")() ?? "auto", set: (value) => scenarios.setProperty(name, "pattern", value === "auto" ? undefined : value),
                choices: [["auto", "auto"], ["lanes", "lanes"], ["crosshatch", "lanes both ways across"], ["orbit", "a circle around it"], ["spiral", "a spiral"], ["look", "one look from beside"]],
              }),
            ]
          : []),
        ...(geometryType === "LineString" ? [number("width_m", "Width", "m", { min: 0, required: true })] : []),
        ...(geometryType === "Point" ? [number("radius_m", "Radius", "m", { min: 0, placeholder: "0" })] : []),
      ];
    case "threat":
      return [
        choiceField({ id: "f-model", label: "Model", choices: ["missile", "radar"], get: get<string>("model"), set: set("model") }),
        number("radius_m", "Radius", "m", { min: 0, required: true }),
        ...(model === "radar" ? [number("intensity_m", "Intensity", "m", { min: 0 })] : []),
        number("height_m", "Height", "m", { min: 0, placeholder: "no limit" }),
        tickField({
          id: "f-hard", label: "Hard: never enter", get: () => get<boolean>("hard")() ?? false,
          set: (value) => scenarios.setProperty(name, "hard", value ? true : undefined),
        }),
      ];
    case "no_fly":
      return [
        ...(geometryType === "Point" ? [number("radius_m", "Radius", "m", { min: 0, required: true })] : []),
        number("floor_m", "Floor", "m amsl", { placeholder: "ground" }),
        number("ceiling_m", "Ceiling", "m amsl", { placeholder: "no limit" }),
      ];
    case "obstacle":
      return [number("height_m", "Height", "m", { min: 0, required: true }), number("base_m", "Base", "m", { placeholder: "0" })];
    case "importance":
      return [
        number("score", "Score", "1/m²", { min: 0, required: true }),
        ...(geometryType === "Point" ? [number("spread_m", "Spread (one standard deviation)", "m", { min: 0, required: true })] : []),
      ];
    case "start":
    case "end":
      return [number("heading_deg", "Heading", "°", { min: 0, max: 360, placeholder: "any" })];
    default:
      return [];
  }
}

// So that findings call properties as the form will, before any form was opened.
for (const [role, type, model] of [["roi", "LineString", ""], ["roi", "Point", ""], ["threat", "Point", "radar"], ["no_fly", "Point", ""], ["obstacle", "Polygon", ""], ["importance", "Point", ""], ["start", "Point", ""]] as const) roleFields("", role, type, model);

/** The question of an import that is still open: what the shape is. */
function doubt(feature: ScenarioFeature): HTMLElement | null {
  const why = feature.properties["role_in_doubt"];
  if (why === undefined) return null;
  const name = nameOf(feature);
  const select = h("select", { id: "f-role" }, ...rolesFor(feature.geometry.type).map((role) => h("option", { value: role }, ROLE_WORDS[role])));
  return h(
    "div",
    { class: "doubt" },
    h("label", { for: "f-role" }, `What is it? ${String(why)}`),
    h("div", { class: "row" }, select, button("It is", () => scenarios.settle(name, select.value as Role), { id: "f-settle" })),
  );
}

/** Its role and its name, once where both are the same word. */
function titleOf(role: string, name: string): string {
  const words = ROLE_WORDS[role] ?? role;
  return words.toLowerCase() === name.toLowerCase() ? words : `${words} ${name}`;
}

/** Build the form for a feature. */
export function featureForm(feature: ScenarioFeature, zoom: () => void): Field {
  const name = nameOf(feature);
  const { role } = feature.properties;
  const geometryType = feature.geometry.type;
  const fields = [
    textField({
      id: "f-name", label: "Name", get: () => name, set: (next) => void scenarios.rename(name, next ?? ""),
      refuse: (next) => (next === "" ? "A name is needed." : next !== name && scenarios.find(next) ? "Another feature has this name." : ""),
    }),
    ...roleFields(name, role, geometryType, feature.properties["model"]),
  ];
  const byCoordinates = coordinateText(feature.geometry) !== null;
  if (byCoordinates) {
    fields.push(
      areaField({
        id: "f-coordinates", label: "Coordinates (longitude, latitude)", rows: geometryType === "Point" ? 1 : 4,
        get: () => { const now = scenarios.find(name); return now ? (coordinateText(now.geometry) ?? "") : ""; },
        set: (text) => scenarios.reshape(name, asGeometry(geometryType, text ?? "")),
        refuse: (text) => refuseCoordinates(geometryType, text),
      }),
    );
  }
  const size = h("p", { class: "quiet", id: "f-size" });
  const measure = (): void => {
    const words = sizeWords(scenarios.find(name)?.geometry ?? feature.geometry);
    size.hidden = words === "";
    fill(size, words);
  };
  const said = h("ul", { class: "findings" });
  const tell = (): void => {
    const found = judgement.value.findings.filter((finding) => finding.feature === name && fieldOf(finding) === null);
    fill(said, ...found.map((finding) => h("li", { class: finding.severity ?? "error" }, findingWords(finding))));
  };
  const element = h(
    "fieldset",
    { class: "card selected" },
    h("legend", {}, titleOf(role, name)),
    doubt(feature),
    size,
    h("div", { class: "grid" }, ...fields.map((field) => field.element)),
    said,
    byCoordinates ? null : h("p", { class: "quiet" }, "This shape has holes or several parts: its outline can be changed only in the file."),
    h(
      "div",
      { class: "row" },
      button("Zoom to", zoom),
      button("Delete", () => scenarios.delete(name), { class: "danger", title: "Delete key" }),
      button("Done", () => scenarios.selection.set(null)),
    ),
  );
  return {
    element,
    sync: () => {
      fields.forEach((field) => field.sync());
      measure();
      tell();
    },
  };
}
