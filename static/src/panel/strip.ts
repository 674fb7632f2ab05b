/** The operating function of a plan: where along the path the sensor is on. */
import { h } from "../dom";
import { pathsOf } from "../phases";
import type { PlanCollection } from "../types";
import { metres } from "../units";

const SVG = "http://www.w3.org/2000/svg";
const WIDTH = 1000;

function svg(tag: string, attributes: Record<string, string | number>, text?: string): SVGElement {
  const element = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
  if (text) element.textContent = text;
  return element;
}

export function operatingStrip(plan: PlanCollection): HTMLElement {
  const collects = plan.features
    .filter((feature) => feature.properties["role"] === "collect")
    .map((feature) => ({ start_m: Number(feature.properties["start_m"]), end_m: Number(feature.properties["end_m"]), roi: String(feature.properties["roi"]) }))
    .filter(({ start_m, end_m }) => Number.isFinite(start_m) && end_m > start_m);
  // Along the whole path, take-off to landing where the plan has them.
  const length_m = Math.max(plan.metrics.length_m, ...pathsOf(plan).map(({ properties }) => Number(properties?.["length_m"] ?? 0)), ...collects.map(({ end_m }) => end_m));
  const chart = svg("svg", { viewBox: `0 0 ${WIDTH} 40`, preserveAspectRatio: "none", role: "img", "aria-label": `Sensor on in ${collects.length} parts of the path` });
  chart.append(svg("line", { x1: 0, y1: 39, x2: WIDTH, y2: 39, class: "axis" }));
  for (const { start_m, end_m, roi } of collects) {
    const bar = svg("rect", { x: (start_m / length_m) * WIDTH, width: ((end_m - start_m) / length_m) * WIDTH, y: 4, height: 35, class: "on" });
    bar.append(svg("title", {}, `${roi}: ${metres(start_m)} to ${metres(end_m)}`));
    chart.append(bar);
  }
  return h("figure", { class: "strip" }, chart, h("figcaption", {}, `Sensor on along the path, 0 to ${metres(length_m)}`));
}
