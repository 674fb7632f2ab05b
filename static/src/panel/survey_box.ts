/** A camera survey in figures: photos, what they take to keep, how sharp they are, how often the regions are seen. */
import { fill, h, section } from "../dom";
import { open, type OpenPlan } from "../plans";
import { CLASSES, sharesOf } from "../survey/overlap";
import { groundWords } from "../survey/readout";
import { hasPhotos } from "../survey/shots";
import { overlap } from "../survey/view";
import { scenarioFeatures } from "../scenario_view";
import type { PlanCamera, Scenario } from "../types";
import { number, percentDown } from "../units";

/** JPEG as cameras write it, and a raw file of 14 bits a pixel. */
const JPEG_BYTES_A_PIXEL = 0.5;
const RAW_BYTES_A_PIXEL = 1.75;
const GIGABYTE = 1e9;

interface Taken {
  camera: PlanCamera;
  count: number;
  /** The photos that follow each other soonest: how far apart, and how soon. */
  interval_m: number;
  least_s: number;
}

/** Photos of each camera, and how soon they follow each other where they do so soonest. */
function taken({ plan }: OpenPlan): Taken[] {
  return (plan.cameras ?? []).flatMap((camera) => {
    const mine = plan.features.filter(({ properties: p }) => p["role"] === "photos" && p["sensor"] === camera.name);
    if (mine.length === 0) return [];
    const times = mine.flatMap(({ properties: p }) => {
      const pass = plan.features.find(({ properties: c }) => c["role"] === "collect" && c["vehicle"] === p["vehicle"] && c["seq"] === p["seq"])?.properties;
      const speed_m_s = pass ? (Number(pass["end_m"]) - Number(pass["start_m"])) / (Number(pass["end_s"]) - Number(pass["start_s"])) : NaN;
      return Number.isFinite(speed_m_s) && Number(p["count"]) > 1 ? [{ interval_m: Number(p["interval_m"]), least_s: Number(p["interval_m"]) / speed_m_s }] : [];
    });
    const soonest = times.sort((a, b) => a.least_s - b.least_s)[0] ?? { interval_m: NaN, least_s: NaN };
    return [{ camera, count: mine.reduce((sum, { properties: p }) => sum + Number(p["count"]), 0), ...soonest }];
  });
}

const storage = (count: number, { columns, rows }: PlanCamera, bytes: number): string => `${((count * columns * rows * bytes) / GIGABYTE).toFixed(1)} GB`;

function cameraRows({ camera, count, interval_m, least_s }: Taken): HTMLElement[] {
  const row = (name: string, value: string, tone = ""): HTMLElement => h("tr", {}, h("th", { scope: "row" }, name), h("td", { class: tone }, value));
  const megapixels = (camera.columns * camera.rows) / 1e6;
  const soon = camera.min_interval_s > 0 && least_s < camera.min_interval_s;
  return [
    row(camera.name, camera.model ?? `${(camera.focal_length_m * 1000).toFixed(1)} mm`),
    row("Photos", `${count} of ${megapixels.toFixed(1)} MP`),
    row("To be kept, JPEG (4 bits a pixel)", storage(count, camera, JPEG_BYTES_A_PIXEL)),
    row("To be kept, raw (14 bits a pixel)", storage(count, camera, RAW_BYTES_A_PIXEL)),
    ...(Number.isFinite(least_s) ? [row("Photos at their closest", `every ${number(interval_m, 1, "m")}, ${number(least_s, 1, "s")}`, soon ? "error" : "")] : []),
    ...(camera.min_interval_s > 0 ? [row("The camera's shortest", number(camera.min_interval_s, 1, "s"), soon ? "error" : "")] : []),
  ];
}

/** The worst and the mean of what footprints tell of each region. */
function qualities({ plan }: OpenPlan): HTMLElement | null {
  const prints = plan.features.filter(({ properties: p }) => p["role"] === "footprint" && (typeof p["gsd_m"] === "number" || typeof p["niirs"] === "number"));
  const regions = [...new Set(prints.map(({ properties: p }) => String(p["roi"])))];
  if (regions.length === 0) return null;
  const values = (roi: string, name: string): number[] => prints.flatMap(({ properties: p }) => (p["roi"] === roi && typeof p[name] === "number" ? [p[name]] : []));
  const mean = (all: number[]): number => all.reduce((sum, value) => sum + value, 0) / all.length;
  const gsd = (roi: string): string => {
    const [worst, means] = [values(roi, "gsd_m"), values(roi, "gsd_mean_m")];
    return worst.length === 0 ? "–" : `${groundWords(Math.max(...worst))}${means.length > 0 ? ` (${groundWords(mean(means))})` : ""}`;
  };
  const niirs = (roi: string): string => {
    const [worst, means] = [values(roi, "niirs"), values(roi, "niirs_mean")];
    return worst.length === 0 ? "–" : `${Math.min(...worst).toFixed(1)}${means.length > 0 ? ` (${mean(means).toFixed(1)})` : ""}`;
  };
  return h(
    "table",
    { class: "compare", id: "quality" },
    h("thead", {}, h("tr", {}, ...["Region", "A pixel, worst (mean)", "NIIRS, worst (mean)"].map((label) => h("th", { scope: "col" }, label)))),
    h("tbody", {}, ...regions.map((roi) => h("tr", {}, h("th", { scope: "row" }, roi), h("td", {}, gsd(roi)), h("td", {}, niirs(roi))))),
  );
}

/** How much of the regions so many photos see, told by as many as the overlaps ask for. */
function seen({ madeFrom }: OpenPlan): HTMLElement | null {
  const found = overlap.value;
  if (!found) return h("p", { class: "warning" }, "How many photos see a place is not known: the height of the ground below is not.");
  const outlines = scenarioFeatures(JSON.parse(madeFrom) as Scenario).flatMap(({ properties, geometry }) => (properties?.["kind"] === "roi" && properties["label"] === false ? [geometry] : []));
  const shares = sharesOf(found, outlines);
  if (!shares) return null;
  return h(
    "table",
    { id: "overlap-shares" },
    h("tbody", {},
      ...CLASSES.map(({ from, colour }, index) =>
        h("tr", {}, h("th", { scope: "row" }, h("span", { class: "block", style: `--c:${colour}`, "aria-hidden": "true" }), from === 1 ? " Regions seen by a photo" : ` by ${from} photos or more`), h("td", {}, percentDown(shares.atLeast[index]))),
      ),
      h("tr", { class: shares.least === 0 ? "short" : "" }, h("th", { scope: "row" }, "Least photos of a place in them"), h("td", {}, shares.least)),
    ),
  );
}

export function surveyBox(): HTMLElement {
  const figures = h("table", { id: "photos" });
  const sharpness = h("div", {});
  const often = h("div", {});
  const head = section("Photos", true, figures, sharpness, often, h("p", { class: "quiet" }, "How often places are seen is counted from where each photo is planned, on ground as high as below it."));
  const draw = (): void => {
    const shown = open.value;
    head.hidden = !hasPhotos(shown);
    if (!shown || head.hidden) return;
    fill(figures, h("tbody", {}, ...taken(shown).flatMap(cameraRows)));
    fill(sharpness, qualities(shown));
  };
  open.watch(draw);
  overlap.watch(() => fill(often, open.value && hasPhotos(open.value) ? seen(open.value) : null));
  return head;
}
