/** Heights along the flight: the aircraft's, the ground's, the parts of the flight; the place pointed at shows on the map. */
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { fill, h, section } from "../dom";
import { part, PHASE_WORDS } from "../phases";
import { open } from "../plans";
import { cursor } from "../survey/cursor";
import { needProfile, profile, type PathProfile } from "../survey/profile";
import { hasPhotos } from "../survey/shots";
import { onThemeChange, palette } from "../theme";
import type { Phase, PlanCollection, Position } from "../types";
import { metres, number } from "../units";

const HEIGHT_PX = 170;
const LEAST_WIDTH_PX = 240;
const OVER = { amsl: "over mean sea level", home: "over home", terrain: "over the ground" } as const;
const style = (name: string): string => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

interface Stretch {
  from_m: number;
  to_m: number;
  words: string;
  colour: string;
}

/** The path's parts, and its passes among them. */
function stretches(plan: PlanCollection, { vehicle, sortie }: PathProfile): Stretch[] {
  const colours = palette();
  const path = plan.features.find(({ properties: p }) => p["role"] === "path" && p["vehicle"] === vehicle && (p["sortie"] ?? 1) === sortie);
  const phases = (path?.properties["phases"] as Phase[] | undefined) ?? [];
  const passes = plan.features.filter(({ properties: p }) => p["role"] === "collect" && p["vehicle"] === vehicle);
  return [
    ...phases.filter(({ kind }) => kind !== "mission").map(({ kind, start_m, end_m }) => ({ from_m: start_m, to_m: end_m, words: PHASE_WORDS[kind].toLowerCase(), colour: colours.phase })),
    ...passes.map(({ properties: p }) => ({ from_m: Number(p["start_m"]), to_m: Number(p["end_m"]), words: `pass ${String(p["seq"])} of ${String(p["roi"])}`, colour: colours.collect })),
  ];
}

/** A height between the places it is told at; null where it is not known. */
function between(line: PathProfile, heights_m: (number | null)[], at_m: number): number | null {
  const after = Math.max(1, line.at_m.findIndex((value) => value >= at_m));
  const [low, high] = [heights_m[after - 1], heights_m[after]];
  if (typeof low !== "number" || typeof high !== "number") return null;
  const [from_m, to_m] = [line.at_m[after - 1] as number, line.at_m[after] as number];
  return to_m > from_m ? low + ((high - low) * (at_m - from_m)) / (to_m - from_m) : high;
}

function words(plan: PlanCollection, line: PathProfile, at_m: number): string {
  const [altitude_m, ground_m] = [between(line, line.altitude_m, at_m), between(line, line.ground_m, at_m)];
  if (altitude_m === null) return "";
  const over = ground_m === null ? `${altitude_m.toFixed(0)} m` : `${(altitude_m - ground_m).toFixed(0)} m over the ground`;
  const where = stretches(plan, line).find(({ from_m, to_m }) => at_m >= from_m && at_m <= to_m)?.words ?? "between passes";
  return `At ${metres(at_m)}: ${over}, ${where}.`;
}

/** The nearest that the mission comes to the ground. */
function least(plan: PlanCollection, line: PathProfile): string {
  const path = plan.features.find(({ properties: p }) => p["role"] === "path" && p["vehicle"] === line.vehicle);
  const mission = ((path?.properties["phases"] as Phase[] | undefined) ?? []).find(({ kind }) => kind === "mission");
  let [lowest_m, there_m] = [Infinity, 0];
  line.at_m.forEach((at_m, index) => {
    const ground_m = line.ground_m[index];
    if (typeof ground_m !== "number" || (mission && (at_m < mission.start_m || at_m > mission.end_m))) return;
    const over_m = (line.altitude_m[index] as number) - ground_m;
    if (over_m < lowest_m) [lowest_m, there_m] = [over_m, at_m];
  });
  return Number.isFinite(lowest_m) ? `Least height over the ground in the mission: ${number(lowest_m, 0, "m")}, at ${metres(there_m)}.` : "How high the ground is below is not known.";
}

function place(plan: PlanCollection, { vehicle, sortie }: PathProfile, at_m: number): Position | null {
  const path = plan.features.find(({ properties: p }) => p["role"] === "path" && p["vehicle"] === vehicle && (p["sortie"] ?? 1) === sortie);
  if (path?.geometry.type !== "LineString") return null;
  const length_m = Number(path.properties["length_m"]);
  const from_m = Math.min(at_m, length_m - 0.01);
  return (part(path.geometry.coordinates, from_m, from_m + 0.01, length_m)[0] as Position | undefined) ?? null;
}

function makeChart(box: HTMLElement, plan: PlanCollection, line: PathProfile, say: (text: string) => void): uPlot {
  const colours = palette();
  const axis = { stroke: style("--quiet"), grid: { stroke: style("--line"), width: 1 }, ticks: { show: false }, font: "11px system-ui" };
  const marked = stretches(plan, line);
  const bands = (chart: uPlot): void => {
    const { left, top, width, height } = chart.bbox;
    chart.ctx.save();
    chart.ctx.beginPath();
    chart.ctx.rect(left, top, width, height);
    chart.ctx.clip();
    for (const { from_m, to_m, colour } of marked) {
      const [from, to] = [chart.valToPos(from_m / 1000, "x", true), chart.valToPos(to_m / 1000, "x", true)];
      chart.ctx.globalAlpha = 0.2;
      chart.ctx.fillStyle = colour;
      chart.ctx.fillRect(from, top, Math.max(1, to - from), height);
    }
    chart.ctx.restore();
  };
  return new uPlot(
    {
      width: Math.max(LEAST_WIDTH_PX, box.clientWidth),
      height: HEIGHT_PX,
      cursor: { y: false, points: { show: false }, drag: { x: false, y: false } },
      scales: { x: { time: false }, m: { range: (_, low, high) => [low, Math.max(high + (high - low) * 0.12, low + 10)] } },
      legend: { show: false },
      axes: [{ ...axis, size: 26, values: (_, ticks) => ticks.map((km) => `${km} km`) }, { ...axis, scale: "m", size: 44 }],
      series: [
        {},
        { label: "height", scale: "m", stroke: colours.path, width: 1.8 },
        { label: "ground", scale: "m", stroke: colours.obstacle, fill: `${colours.obstacle}55`, width: 1.2, fillTo: (chart) => chart.scales["m"]?.min ?? 0 },
      ],
      hooks: {
        drawClear: [bands],
        setCursor: [
          (chart) => {
            const { left } = chart.cursor;
            const at_m = left === undefined || left < 0 ? NaN : chart.posToVal(left, "x") * 1000;
            const on = at_m >= 0 && at_m <= (line.at_m.at(-1) as number);
            say(on ? words(plan, line, at_m) : "");
            cursor.set(on ? place(plan, line, at_m) : null);
          },
        ],
      },
    },
    [line.at_m.map((at_m) => at_m / 1000), line.altitude_m, line.ground_m],
    box,
  );
}

export function profileBox(): HTMLElement {
  const box = h("div", { id: "profile" });
  const which = h("select", { id: "profile-path", hidden: true, "aria-label": "Whose heights" });
  const about = h("p", { class: "quiet", id: "profile-about" });
  const pointed = h("p", { id: "profile-at", role: "status" });
  const key = h("div", { class: "key" });
  const head = section("Height profile", false, which, h("div", { class: "chart" }, box, key), pointed, about);
  let chart: uPlot | null = null;
  const draw = (): void => {
    chart?.destroy();
    chart = null;
    const shown = open.value;
    const line = profile.value?.paths[Number(which.value) || 0];
    fill(pointed);
    if (!shown || !profile.value || !line) {
      fill(about, head.open ? "Being read …" : "");
      fill(key);
      return;
    }
    if (!head.open || box.clientWidth === 0) return;
    const colours = palette();
    const flat = profile.value.ground === "flat";
    fill(
      key,
      h("span", { style: `--k: ${colours.path}` }, `height ${OVER[profile.value.altitude_reference]}, m`),
      h("span", { style: `--k: ${colours.obstacle}` }, flat ? "ground, flat at the height of home" : "ground"),
      h("span", { style: `--k: ${colours.collect}` }, "pass"),
      h("span", { style: `--k: ${colours.phase}` }, "take-off, climb, return, landing"),
    );
    fill(about, least(shown.plan, line));
    box.setAttribute("role", "img");
    box.setAttribute("aria-label", `Heights along the flight. ${least(shown.plan, line)}`);
    chart = makeChart(box, shown.plan, line, (text) => pointed.textContent !== text && fill(pointed, text));
  };
  head.addEventListener("toggle", () => {
    if (head.open) void needProfile();
    draw();
  });
  which.addEventListener("change", draw);
  box.addEventListener("mouseleave", () => cursor.set(null));
  let last: string | null = null;
  open.watch((shown) => {
    head.hidden = shown === null;
    cursor.set(null);
    const id = shown?.record.id ?? null;
    if (id === last) return;
    last = id;
    // With photos the ground decides what they see.
    head.open = hasPhotos(shown);
    if (head.open) void needProfile();
  });
  profile.watch((found) => {
    fill(which, ...(found?.paths ?? []).map(({ vehicle, sortie }, index) => h("option", { value: index }, (found?.paths.length ?? 0) > 1 ? `${vehicle}, flight ${sortie}` : vehicle)));
    which.hidden = (found?.paths.length ?? 0) < 2;
    draw();
  });
  new ResizeObserver(() => {
    if (chart && Math.abs(chart.width - box.clientWidth) > 1 && box.clientWidth > 0) chart.setSize({ width: Math.max(LEAST_WIDTH_PX, box.clientWidth), height: HEIGHT_PX });
    else if (!chart && box.clientWidth > 0) draw();
  }).observe(box);
  onThemeChange(draw);
  return head;
}
