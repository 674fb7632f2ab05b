/** A small live chart of the flight: height above home, and distance from the planned line. */
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { h } from "../dom";
import { watched } from "../fleet";
import { offLine_m } from "../geo";
import { open } from "../plans";
import { onThemeChange } from "../theme";
import type { Position } from "../types";

const MOST_POINTS = 1500;
const HEIGHT_PX = 150;
const LEAST_WIDTH_PX = 200;
const OFF_LIMIT_M = 30;

type Column = (number | null)[];

function style(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

function makeChart(box: HTMLElement): uPlot {
  const axis = { stroke: style("--quiet"), grid: { stroke: style("--line"), width: 1 }, size: 44 };
  return new uPlot(
    {
      width: Math.max(LEAST_WIDTH_PX, box.clientWidth),
      height: HEIGHT_PX,
      // Beyond this the aircraft climbs or lands; the interest is in metres.
      scales: { x: { time: false }, off: { range: [-OFF_LIMIT_M, OFF_LIMIT_M] } },
      legend: { show: false },
      axes: [{ ...axis, size: 26 }, { ...axis, scale: "m" }, { ...axis, scale: "off", side: 1, grid: { show: false } }],
      series: [
        { label: "s" },
        { label: "height, m", scale: "m", stroke: style("--accent"), width: 1.5 },
        { label: "off the line, m", scale: "off", stroke: style("--bad"), width: 1.2 },
      ],
    },
    [[], [], []],
    box,
  );
}

export function flightChart(): HTMLElement {
  const box = h("div", { "aria-label": "Height and distance from the planned line, live", role: "img" });
  const key = h(
    "div",
    { class: "key", hidden: true },
    h("span", { style: "--k: var(--accent)" }, "height over home, m (left)"),
    h("span", { style: "--k: var(--bad)" }, "right of the planned line, m (right)"),
    h("span", { style: "--k: transparent" }, "across: seconds"),
  );
  let chart: uPlot | null = null;
  let columns: [number[], Column, Column] = [[], [], []];
  let flight: string | null = null;
  let begun_s = 0;
  const draw = (): void => {
    if (columns[0].length < 2 || box.clientWidth === 0) return;
    chart ??= makeChart(box);
    key.hidden = false;
    if (Math.abs(chart.width - box.clientWidth) > 1) chart.setSize({ width: Math.max(LEAST_WIDTH_PX, box.clientWidth), height: HEIGHT_PX });
    chart.setData(columns);
  };
  watched.watch((vehicle) => {
    if (!vehicle || vehicle.flight_id === null) return;
    if (vehicle.flight_id !== flight) {
      flight = vehicle.flight_id;
      begun_s = vehicle.state.time_s ?? 0;
      columns = [[], [], []];
    }
    const { lon_deg, lat_deg, relative_altitude_m, time_s } = vehicle.state;
    // The aircraft's own clock: a simulated one may be quicker than ours.
    const flown_s = (time_s ?? NaN) - begun_s;
    if (lon_deg === null || lat_deg === null || !Number.isFinite(flown_s) || flown_s <= (columns[0].at(-1) ?? -1)) return;
    const path = open.value?.record.id === vehicle.plan_id ? open.value.plan.features.find((f) => f.properties["role"] === "path") : undefined;
    const line = path?.geometry.type === "LineString" ? path.geometry.coordinates : [];
    const at: Position = [lon_deg, lat_deg];
    columns[0].push(flown_s);
    columns[1].push(relative_altitude_m);
    columns[2].push(line.length > 1 ? offLine_m(at, line) : null);
    if (columns[0].length > MOST_POINTS) columns.forEach((column) => column.splice(0, column.length - MOST_POINTS));
    draw();
  });
  onThemeChange(() => {
    chart?.destroy();
    chart = null;
    draw();
  });
  return h("div", { class: "chart" }, box, key);
}
