/** The sensors on board: a radar or a camera each, the camera from the service's database or by its figures. */
import { completed } from "../airframes";
import { cameras, heightFor_m, known, like, opticsOf, radars, seenFrom } from "../cameras";
import { button, fill, h, section } from "../dom";
import { news } from "../notices";
import { emptyScenario, scenarios } from "../scenario";
import { groundWords } from "../survey/readout";
import type { Member } from "../types";
import { number as shown } from "../units";
import { goToField } from "./field_findings";
import { choiceField, numberField, suggestField, tickField, type Field } from "./fields";
import { choice, member, name, number, tick, tidy } from "./members";

type Kind = "sar" | "camera";
const KINDS = [["sar", "radar (SAR)"], ["camera", "camera"]] as const;
const CAMERA_ALTITUDE_M = 100;
const FORWARD_OVERLAP = 0.75;
const SIDE_OVERLAP = 0.65;
const PERCENT = 100;
const MOST_LIKE = 6;
const MILLI = 1000;
const MICRO = 1_000_000;

const sensorAt = (index: number): Member | undefined => scenarios.document.value.sensors?.[index];
const isCamera = (sensor: Member | undefined): boolean => sensor?.["type"] === "camera";

function made(kind: Kind, called: string): Member {
  return kind === "camera" ? { name: called, type: "camera" } : { ...structuredClone(emptyScenario().sensors?.[0]), name: called };
}

/** A name that no sensor has. */
function freeName(kind: Kind, taken: Member[]): string {
  const names = new Set(taken.map((sensor) => String(sensor["name"])));
  const stem = kind === "camera" ? "camera" : "sar";
  let [called, number] = [stem, 1];
  while (names.has(called)) called = `${stem}-${(number += 1)}`;
  return called;
}

/** The other kind takes its place, under its own name; an altitude that nobody chose becomes one for cameras. */
function turnInto(index: number, kind: Kind): void {
  scenarios.change((draft) => {
    const sensors = draft.sensors ?? [];
    const others = sensors.filter((_, i) => i !== index);
    sensors[index] = made(kind, freeName(kind, others));
    for (const feature of draft.features) if (feature.properties["sensor"] !== undefined && !sensors.some((sensor) => sensor["name"] === feature.properties["sensor"])) delete feature.properties["sensor"];
    if (kind === "camera" && others.length === 0 && draft.altitude_m === emptyScenario().altitude_m) {
      draft.altitude_m = CAMERA_ALTITUDE_M;
      news(`The altitude is ${CAMERA_ALTITUDE_M} m now, as is usual with cameras. Left empty, regions are flown over as high as the pixel they ask for allows.`);
    }
  });
}

function add(kind: Kind): void {
  scenarios.change((draft) => {
    const sensors = draft.sensors ?? [];
    const like = [...sensors].reverse().find((sensor) => isCamera(sensor) === (kind === "camera"));
    const called = freeName(kind, sensors);
    draft.sensors = [...sensors, like ? { ...structuredClone(like), name: called } : made(kind, called)];
  });
  const first = document.getElementById(`sensors-${(scenarios.document.value.sensors?.length ?? 1) - 1}-type`);
  if (first) goToField(first);
}

function removeSensor(index: number): void {
  scenarios.change((draft) => {
    const [gone] = draft.sensors?.splice(index, 1) ?? [];
    for (const feature of draft.features) if (feature.properties["sensor"] === gone?.["name"]) delete feature.properties["sensor"];
  });
}

function typeField(index: number): Field {
  const { get } = member("sensors", index, "type");
  return choiceField({ id: `sensors-${index}-type`, label: "What it is", choices: KINDS, get: () => get<string>() ?? "sar", set: (value) => turnInto(index, value as Kind) });
}

/** What of a database's radar is no figure of it. */
const NO_FIGURES = new Set(["name", "type", "source"]);
const figuresOf = (radar: Member): [string, unknown][] => Object.entries(radar).filter(([property, value]) => !NO_FIGURES.has(property) && value !== null);

/** The radar whose figures the sensor has, all of them. */
const likeWhich = (sensor: Member | undefined): string => radars.value.find((radar) => figuresOf(radar).every(([property, value]) => (sensor?.[property] ?? (property === "mode" ? "stripmap" : undefined)) === value))?.name ?? "";

/** Figures of a radar of the database, to begin with; all of them can be changed. */
function presetField(index: number): Field {
  const select = h("select", { id: `sensors-${index}-preset` });
  select.addEventListener("change", () => {
    const chosen = radars.value.find(({ name: called }) => called === select.value);
    if (!chosen) return;
    scenarios.change((draft) => {
      const before = draft.sensors?.[index];
      if (draft.sensors && before) draft.sensors[index] = { name: before["name"], type: "sar", ...Object.fromEntries(figuresOf(chosen)) };
    });
  });
  const sync = (): void => {
    if (select.options.length !== radars.value.length + 1) fill(select, h("option", { value: "" }, "its own"), ...radars.value.map(({ name: called }) => h("option", { value: called }, called)));
    select.value = likeWhich(sensorAt(index));
  };
  radars.watch(sync);
  return { element: h("div", { class: "field wide" }, h("label", { for: select.id }, "Published figures of"), select), sync };
}

/** Absent is to keep the overlap up to the edges. */
function edges(index: number): Field {
  const { get, set } = member("sensors", index, "edge_overlap");
  return tickField({
    id: `sensors-${index}-edge_overlap`, label: "One photo is enough at edges", hint: "As surveys of other programs do it: fewer lanes, less overlap along a region's edges",
    get: () => get<boolean>() === false, set: (value) => set(value ? false : undefined),
  });
}

function radar(index: number): Field[] {
  return [
    presetField(index),
    choice("sensors", index, "look", "Looks", ["right", "left", "both"]),
    choice("sensors", index, "mode", "Mode", ["stripmap", "spotlight", ["scansar", "ScanSAR"]]),
    number("sensors", index, "incidence_deg", "Incidence", "°", { max: 90, required: true }),
    number("sensors", index, "elevation_beamwidth_deg", "Beam, elevation", "°", { max: 180, required: true }),
    number("sensors", index, "azimuth_beamwidth_deg", "Beam, azimuth", "°", { max: 180, placeholder: "from the aperture" }),
    number("sensors", index, "aperture_length_m", "Aperture length", "m"),
    number("sensors", index, "wavelength_m", "Wavelength", "m"),
    number("sensors", index, "resolution_m", "Resolution", "m"),
    number("sensors", index, "squint_deg", "Squint", "°", { min: -60, max: 60, placeholder: "0", hint: "Forward is positive" }),
    ...(sensorAt(index)?.["mode"] === "scansar" ? [number("sensors", index, "sub_swaths", "Sub-swaths", "", { min: 1, placeholder: "3" })] : []),
    tick("sensors", index, "stabilised", "Steered abeam of the course", "In wind an antenna fixed to the aircraft turns with the nose; a steered one does not"),
    ...margins(index, "beam", "swath"),
  ];
}

function margins(index: number, angle: string, width: string): Field[] {
  return [
    number("sensors", index, "pointing_margin_deg", "Pointing margin", "°", { max: 15, placeholder: "its autopilot's", hint: `Planned with this much less of the ${angle} at every edge, because the aircraft sways; left empty, what its autopilot needs: 1.5° to 3°` }),
    number("sensors", index, "position_margin_m", "Position margin", "m", { placeholder: "its autopilot's", hint: `Planned with this much less of the ${width} at every edge, because the aircraft is not quite on its line; left empty, what its autopilot needs: 2 to 5 m` }),
  ];
}

function setModel(index: number, model: string | undefined): void {
  scenarios.change((draft) => {
    const sensor = draft.sensors?.[index];
    if (!sensor) return;
    const before = opticsOf(sensor);
    delete sensor["model"];
    for (const property of ["focal_length_m", "pixel_pitch_m", "image_px"]) delete sensor[property];
    if (model !== undefined) sensor["model"] = known(model)?.name ?? model;
    else if (before) Object.assign(sensor, { focal_length_m: before.focal_length_m, pixel_pitch_m: before.pixel_pitch_m, image_px: [before.columns, before.rows] });
  });
}

function modelField(index: number): Field {
  return suggestField({
    id: `sensors-${index}-model`, label: "Camera and lens", placeholder: "search by maker, model, lens", wide: true,
    hint: "From the service's database; left empty, by its figures below",
    suggestions: cameras, words: (camera) => `${camera.kind}, ${(camera.focal_length_m * MILLI).toFixed(1)} mm, ${camera.image_px.join(" × ")}`,
    get: () => sensorAt(index)?.["model"] as string | undefined,
    set: (model) => setModel(index, model),
    refuse: (text) => {
      if (text === "" || known(text) || cameras.value.length === 0) return "";
      const several = like(text);
      if (several.length > 0) return `Several are called so: ${several.slice(0, MOST_LIKE).map(({ name: called }) => called).join(", ")}${several.length > MOST_LIKE ? " …" : ""}. Say which.`;
      return "The database has no camera of this name: choose one of those shown, or leave this empty and give its figures.";
    },
  });
}

/** Pixels across or along the flight direction. */
function pixels(index: number, which: 0 | 1, label: string): Field {
  const { get, set } = member("sensors", index, "image_px");
  return numberField({
    id: `sensors-${index}-image_px${which === 0 ? "" : "-along"}`, label, unit: "px", min: 1, required: true,
    get: () => get<number[]>()?.[which],
    set: (value) => {
      const now = [...(get<number[]>() ?? [])];
      now[which] = value ?? 0;
      set([now[0] ?? 0, now[1] ?? 0]);
    },
  });
}

function camera(index: number): Field[] {
  const figures = sensorAt(index)?.["model"] === undefined;
  return [
    modelField(index),
    ...(figures
      ? [
          number("sensors", index, "focal_length_m", "Focal length", "mm", { scale: MILLI, required: true, hint: "Of the lens itself, not its equivalent on 35 mm film" }),
          number("sensors", index, "pixel_pitch_m", "Pixel pitch", "µm", { scale: MICRO, required: true, hint: "The chip's width over its columns" }),
          pixels(index, 0, "Image across the course"),
          pixels(index, 1, "Image along the course"),
          choice("sensors", index, "spectrum", "Sees", [["visible", "visible light"], "infrared"]),
        ]
      : []),
    number("sensors", index, "forward_overlap", "Forward overlap", "%", { scale: PERCENT, max: 99, placeholder: String(FORWARD_OVERLAP * PERCENT), hint: "Of a photo, what the next one sees again" }),
    number("sensors", index, "side_overlap", "Side overlap", "%", { scale: PERCENT, max: 99, placeholder: String(SIDE_OVERLAP * PERCENT), hint: "Of a photo, what the next lane's see again" }),
    edges(index),
    number("sensors", index, "tilt_deg", "Tilt", "°", { min: -90, max: 90, placeholder: "0", hint: "From straight down forwards" }),
    choice("sensors", index, "trigger", "Photos", [["distance", "by distance"], ["time", "by time"], ["video", "a video of each pass"]]),
    ...(sensorAt(index)?.["trigger"] === "video" ? [] : [number("sensors", index, "min_interval_s", "Shortest interval", "s", { placeholder: figures ? "not known" : "the maker's" })]),
    tick("sensors", index, "stabilised", "A gimbal keeps it along the course", "In wind a camera fixed to a wing turns with its nose; a multirotor's is along its course anyway"),
    number("sensors", index, "rer", "Edge response (RER)", "", { max: 2, placeholder: "not known", hint: "With the signal to noise ratio it tells the NIIRS of its images" }),
    number("sensors", index, "snr", "Signal to noise", "", { placeholder: "not known", hint: "With the edge response it tells the NIIRS of its images" }),
    ...margins(index, "image", "image"),
  ];
}

/** What the camera makes of the height flown at, told while it is being set up. */
function hint(index: number): Field {
  const words = h("p", { class: "quiet live", id: `sensors-${index}-seen`, role: "status" });
  return {
    element: words,
    sync: () => {
      const sensor = sensorAt(index);
      const { altitude_m, altitude_reference, vehicles, features } = scenarios.document.value;
      const optics = opticsOf(sensor);
      const share = (property: string, usual: number): number => (typeof sensor?.[property] === "number" ? sensor[property] : usual);
      if (!optics) return fill(words, sensor?.["model"] === undefined ? "Choose the camera, or give its figures." : "");
      const [forward, side] = [share("forward_overlap", FORWARD_OVERLAP), share("side_overlap", SIDE_OVERLAP)];
      const speed_m_s = Number(completed(vehicles?.[0] ?? {})["airspeed_m_s"]);
      const from = (height_m: number, whence: string): string => {
        const seen = seenFrom(optics, height_m, forward, side);
        const soon = speed_m_s > 0 ? `, ${shown(seen.photos_m / speed_m_s, 1, "s")} at ${shown(speed_m_s, 0, "m/s")}` : "";
        return `${whence} a pixel covers ${groundWords(seen.gsd_m)}, a photo ${seen.across_m.toFixed(0)} × ${seen.along_m.toFixed(0)} m; lanes lie ${shown(seen.lanes_m, 1, "m")} apart, photos ${shown(seen.photos_m, 1, "m")}${soon}.`;
      };
      const gsds = features.map(({ properties: p }) => p["gsd_m"]).filter((value): value is number => typeof value === "number" && value > 0);
      const finest_m = gsds.length > 0 ? Math.min(...gsds) : null;
      const tilt = share("tilt_deg", 0) === 0 ? "" : " Straight down; the tilt adds to it.";
      const set = typeof altitude_m === "number" && altitude_reference !== "amsl";
      const high = set ? from(altitude_m, finest_m === null ? `From ${altitude_m} m` : `Flown at the altitude that is set, ${altitude_m} m:`) : "";
      const wished = finest_m === null ? "" : from(tidy(Number(heightFor_m(optics, finest_m).toFixed(1))), `${set ? "Left empty, " : ""}${groundWords(finest_m)} a pixel asks for ${heightFor_m(optics, finest_m).toFixed(0)} m: from there`);
      fill(words, [high, wished].filter(Boolean).join(" ") + (high || wished ? tilt : "The height decides what it sees: set an altitude, or what a region asks for."));
    },
  };
}

/** What decides which fields there are. */
export const sensorsKey = (sensors: Member[]): string => sensors.map((sensor) => [sensor["type"], sensor["mode"] === "scansar", sensor["model"] === undefined, sensor["trigger"] === "video"].join()).join(";");

/** A section for each sensor; `grid` takes their fields. */
export function sensorSections(grid: (fields: Field[]) => HTMLElement, plain: (field: Field) => HTMLElement): HTMLElement[] {
  const sensors = scenarios.document.value.sensors ?? [];
  return sensors.map((sensor, index) =>
    section(
      sensors.length > 1 ? `Sensor ${index + 1}` : "Sensor",
      false,
      grid([typeField(index), name("sensors", index)]),
      isCamera(sensor) ? plain(hint(index)) : null,
      grid(isCamera(sensor) ? camera(index) : radar(index)),
      h(
        "div",
        { class: "row" },
        ...(index === sensors.length - 1 ? [button("Add a camera", () => add("camera")), button("Add a radar", () => add("sar"))] : []),
        sensors.length > 1 ? button("Remove", () => removeSensor(index), { class: "danger", "aria-label": `Remove sensor ${index + 1}` }) : null,
      ),
    ),
  );
}
