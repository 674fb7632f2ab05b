/** The segments round the targets of the plan on the map: read once they are asked for, told under the pointer. */
import type { Feature, FeatureCollection } from "geojson";
import type { Map as MapLibreMap } from "maplibre-gl";
import { get } from "./api";
import { isShown, ticks } from "./legend";
import { setData } from "./map";
import { attempt } from "./notices";
import { open } from "./plans";
import { Signal } from "./signal";
import { metres, number, percentDown } from "./units";

export const NETWORK = "network";

interface Finding {
  message: string;
}

/** A feature of role `segment`. */
interface Segment {
  target: string;
  sensor: string;
  look: "left" | "right" | "down";
  heading_deg: number;
  vehicles: string[];
  stand_off_m: number;
  passes: number;
  seen: number | null;
  resolution_m: number | null;
  gsd_m: number | null;
  niirs: number | null;
  risk_missile: number;
  risk_radar: number;
  state: "chosen" | "open" | "ruled_out";
  longer_m: number | null;
  ruled_out: Finding[];
}

/** Segments that are drawn, by state. */
export const segments = new Signal<Record<string, number>>({});

const NOTABLE_M = 0.5;

function becauseOf(own: Segment): string {
  if (own.state === "chosen") return `chosen, flown by ${own.vehicles.join(", ")}`;
  if (own.state === "ruled_out") return `ruled out: ${own.ruled_out.map(({ message }) => message).join("; ")}`;
  if (own.longer_m === null) return "open";
  if (Math.abs(own.longer_m) < NOTABLE_M) return "open, as long as the one chosen";
  return `open, the flight ${metres(Math.abs(own.longer_m))} ${own.longer_m < 0 ? "shorter" : "longer"} with it`;
}

/** A segment in one line. */
export function wordsOf(own: Segment): string {
  const quality = [
    own.resolution_m === null ? "" : `resolution ${number(own.resolution_m, 2, "m")}`,
    own.gsd_m === null ? "" : `${number(own.gsd_m * 100, 1, "cm")} a pixel`,
    own.niirs === null ? "" : `NIIRS ${number(own.niirs, 1)}`,
  ].filter(Boolean);
  const risks = own.risk_missile + own.risk_radar > 0 ? `risk ${number(own.risk_missile, 2)} missile, ${number(own.risk_radar, 2)} radar` : "no threat";
  const passes = own.passes === 1 ? "" : `${own.passes} passes`;
  return [
    `${own.target} by ${own.sensor}`,
    `heading ${own.heading_deg.toFixed(0)}°, looking ${own.look}, ${metres(own.stand_off_m)} off`,
    passes,
    ...quality,
    own.seen === null ? "" : `sees ${percentDown(own.seen)}`,
    risks,
    becauseOf(own),
  ].filter(Boolean).join(" · ");
}

/** What is told of the segment under a box of the screen; nothing where there is none. */
export function segmentAt(map: MapLibreMap, around: [[number, number], [number, number]]): string {
  if (!isShown(NETWORK)) return "";
  const [found] = map.queryRenderedFeatures(around, { layers: ["network-chosen", "network-open", "network-ruled_out"] });
  return String(found?.properties["words"] ?? "");
}

export function showNetwork(map: MapLibreMap): void {
  let drawn: string | null = null;
  const draw = (features: Feature[]): void => {
    const counts: Record<string, number> = {};
    for (const { properties } of features) if (properties?.["role"] === "segment") counts[String(properties["state"])] = (counts[String(properties["state"])] ?? 0) + 1;
    setData(map, NETWORK, features.map((feature) => (feature.properties?.["role"] === "segment" ? { ...feature, properties: { ...feature.properties, words: wordsOf(feature.properties as unknown as Segment) } } : feature)));
    segments.set(counts);
  };
  const look = async (): Promise<void> => {
    const id = isShown(NETWORK) ? (open.value?.record.id ?? null) : null;
    if (id === drawn) return;
    if (drawn !== null) draw([]);
    drawn = id;
    if (id === null) return;
    const found = await attempt("The segments round the targets were not read", () => get<FeatureCollection>(`/plans/${encodeURIComponent(id)}/network.geojson`));
    if (drawn !== id) return;
    if (found) draw(found.features);
    else drawn = null;
  };
  open.watch(() => void look());
  ticks.watch(() => void look());
}
