/** Who does what when: a bar for every flight on one clock, and a slider that moves all aircraft on the map. */
import { clock_s, flights, isDark } from "../crew/clock";
import { coloursOf, doing, placeAt, type Flight } from "../crew/flights";
import { button, fill, h, section } from "../dom";
import { distance_m } from "../geo";
import { PHASE_WORDS } from "../phases";
import { isSearch, open } from "../plans";
import { scenarios } from "../scenario";
import { onThemeChange, palette } from "../theme";
import { foundByNow, looked } from "../search/view";
import { metres, number, percent, seconds } from "../units";

const SVG = "http://www.w3.org/2000/svg";
const WIDTH = 1000;
const ROW = 26;
const FRAME_MS = 80;
/** A whole plan is played in so long. */
const PLAY_S = 40;

function svg(tag: string, attributes: Record<string, string | number>, ...children: (SVGElement | string)[]): SVGElement {
  const element = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
  element.append(...children);
  return element;
}

const titled = (attributes: Record<string, string | number>, words: string): SVGElement => svg("rect", attributes, svg("title", {}, words));

/** The times between which each region may be seen, where the scenario says. */
function windows(): Map<string, [number, number]> {
  const found = scenarios.document.value.features.flatMap(({ id, properties }) => {
    const window_s = properties["time_window_s"];
    return Array.isArray(window_s) ? [[String(id ?? properties.name ?? ""), [Number(window_s[0]), Number(window_s[1])]] as [string, [number, number]]] : [];
  });
  return new Map(found);
}

const clockWords = (at_s: number): string => {
  const whole = Math.round(at_s);
  const two = (value: number): string => String(value).padStart(2, "0");
  return `${Math.floor(whole / 3600)}:${two(Math.floor((whole % 3600) / 60))}:${two(whole % 60)}`;
};

function row(flight: Flight, index: number, scale: number, colour: string, asked: Map<string, [number, number]>): SVGElement[] {
  const y = index * ROW;
  const colours = palette();
  const x = (at_s: number): number => at_s * scale;
  const bar = (from_s: number, to_s: number, top: number, height: number, fill_: string, words: string, opacity = 1): SVGElement =>
    titled({ x: x(from_s), width: Math.max(1.5, (to_s - from_s) * scale), y: y + top, height, fill: fill_, opacity }, words);
  const spans = (from_s: number, to_s: number): string => `${clockWords(from_s)} to ${clockWords(to_s)}`;
  const brackets = [...new Set(flight.passes.map(({ roi }) => roi))].flatMap((roi) => {
    const window_s = asked.get(roi);
    return window_s ? [bar(window_s[0], window_s[1], 2, 3, colours.radar, `${roi} may be seen ${spans(...window_s)}`, 0.9)] : [];
  });
  return [
    bar(flight.start_s, flight.end_s, 10, 6, colour, `${flight.vehicle} flies ${spans(flight.start_s, flight.end_s)}`, 0.35),
    ...flight.phases.filter(({ kind }) => kind !== "mission").map((phase) => bar(phase.start_s, phase.end_s, 9, 8, colours.phase, `${PHASE_WORDS[phase.kind]}, ${spans(phase.start_s, phase.end_s)}`, 0.8)),
    ...flight.passes.map((pass) => bar(pass.start_s, pass.end_s, 6, 14, colour, `${flight.vehicle}, pass ${pass.seq}: ${pass.roi} with ${pass.sensor}, ${spans(pass.start_s, pass.end_s)}`)),
    ...brackets,
  ];
}

/** Round times across the chart, not too many. */
function marks(end_s: number): { every_s: number; at_s: number[] } {
  const every_s = [60, 120, 300, 600, 900, 1800, 3600, 7200].find((step) => end_s / step <= 7) ?? 14_400;
  return { every_s, at_s: Array.from({ length: Math.floor(end_s / every_s) + 1 }, (_, index) => index * every_s) };
}

const ticks = (end_s: number, height: number): SVGElement[] =>
  marks(end_s).at_s.map((at_s) => svg("line", { x1: (at_s / end_s) * WIDTH, x2: (at_s / end_s) * WIDTH, y1: 0, y2: height, class: "tick" }));

function tickWords(end_s: number): HTMLElement {
  const { every_s, at_s: all } = marks(end_s);
  const minutes = every_s < 3600 && end_s < 3600;
  // The last may stand where its words would be cut off by the chart's end.
  const place = (at_s: number): string => (at_s > 0.87 * end_s ? "right:0" : `left:${((at_s / end_s) * 100).toFixed(2)}%`);
  const words = all.map((at_s) => h("span", { style: place(at_s) }, minutes ? `${Math.round(at_s / 60)} min` : clockWords(at_s).slice(0, -3)));
  return h("div", { class: "hours", "aria-hidden": "true" }, ...words);
}

const nameOf = (flight: Flight, all: Flight[]): string => (all.filter(({ vehicle }) => vehicle === flight.vehicle).length > 1 ? `${flight.vehicle}, flight ${flight.sortie}` : flight.vehicle);

/** The nearest that two aircraft in the air are to one another at a second. */
function nearest(all: Flight[], at_s: number): string {
  const places = all.flatMap((flight) => {
    const place = placeAt(flight, at_s);
    return place ? [{ name: flight.vehicle, ...place }] : [];
  });
  let best: { words: string; off_m: number } | null = null;
  for (let i = 0; i < places.length; i += 1) {
    for (let j = i + 1; j < places.length; j += 1) {
      const [a, b] = [places[i], places[j]];
      if (!a || !b) continue;
      const off_m = distance_m(a.at, b.at);
      const up_m = a.altitude_m !== null && b.altitude_m !== null ? Math.abs(a.altitude_m - b.altitude_m) : null;
      if (!best || off_m < best.off_m) best = { off_m, words: `Nearest: ${a.name} and ${b.name}, ${metres(off_m)} apart${up_m === null ? "" : `, ${number(up_m, 0, "m")} in height`}.` };
    }
  }
  return best?.words ?? "";
}

export function crewBox(): HTMLElement {
  const chart = h("div", { class: "gantt" });
  const slider = h("input", { type: "range", id: "clock", min: 0, max: 1, step: 1, value: 0, "aria-label": "Time in the plan" });
  const play = button("Play", () => toggle(), { id: "clock-play", title: "Moves all aircraft on the map along their lines" });
  const now = h("output", { id: "clock-now", for: "clock" });
  const list = h("ul", { class: "doing", id: "doing" });
  const near = h("p", { class: "quiet", id: "clock-near" });
  const share = h("p", { id: "clock-found", class: "quiet" });
  const hand = svg("line", { class: "hand", y1: 0 });
  const box = section("Who does what, and when", true, chart, h("div", { class: "row clock" }, play, slider, now), share, list, near);
  box.id = "crew";
  let timer: ReturnType<typeof setInterval> | null = null;
  let end_s = 1;
  let last: string | null = null;
  let colours = new Map<string, string>();

  const stop = (): void => {
    if (timer !== null) clearInterval(timer);
    timer = null;
    fill(play, "Play");
  };
  const toggle = (): void => {
    if (timer !== null) return stop();
    const from_s = clock_s.value === null || clock_s.value >= end_s ? 0 : clock_s.value;
    const began = performance.now();
    fill(play, "Pause");
    timer = setInterval(() => {
      const at_s = from_s + ((performance.now() - began) / 1000) * (end_s / PLAY_S);
      clock_s.set(Math.min(end_s, at_s));
      if (at_s >= end_s) stop();
    }, FRAME_MS);
  };
  slider.addEventListener("input", () => {
    stop();
    clock_s.set(Number(slider.value));
  });
  const draw = (): void => {
    const shown = open.value;
    const all = flights.value;
    box.hidden = all.length === 0;
    if (!shown || all.length === 0) return stop();
    // One aircraft alone is told of by its figures; several are not understood without it.
    if (shown.record.id !== last) box.open = all.length > 1 || isSearch(shown.plan);
    last = shown.record.id;
    colours = coloursOf(shown.plan, isDark());
    end_s = Math.max(1, ...all.map((flight) => flight.end_s));
    slider.max = String(Math.ceil(end_s));
    const height = all.length * ROW;
    const asked = windows();
    const usual = palette().collect;
    const figure = svg("svg", { viewBox: `0 0 ${WIDTH} ${height}`, preserveAspectRatio: "none", role: "img", "aria-label": `${all.length} flights, the last lands after ${seconds(end_s)}`, style: `height:${height}px` });
    figure.append(...ticks(end_s, height), ...all.flatMap((flight, index) => row(flight, index, WIDTH / end_s, colours.get(flight.vehicle) ?? usual, asked)), hand);
    hand.setAttribute("y2", String(height));
    figure.addEventListener("click", (event) => {
      const rect = figure.getBoundingClientRect();
      stop();
      clock_s.set(Math.min(end_s, Math.max(0, ((event.clientX - rect.left) / rect.width) * end_s)));
    });
    fill(
      chart,
      h("div", { class: "names" }, ...all.map((flight) => h("span", { style: `--c:${colours.get(flight.vehicle) ?? usual};height:${ROW}px`, title: nameOf(flight, all) }, nameOf(flight, all)))),
      h("div", { class: "bars" }, figure as unknown as HTMLElement, tickWords(end_s)),
    );
    tell();
  };
  const tell = (): void => {
    const at_s = clock_s.value;
    const all = flights.value;
    hand.style.display = at_s === null ? "none" : "";
    if (at_s === null) {
      slider.value = "0";
      fill(now, "");
      fill(list);
      fill(near);
      fill(share, looked.value ? "Move the slider, or press Play: what is still to be found is drawn as it is then." : "");
      return;
    }
    const x = String((at_s / end_s) * WIDTH);
    hand.setAttribute("x1", x);
    hand.setAttribute("x2", x);
    if (document.activeElement !== slider || timer !== null) slider.value = String(Math.round(at_s));
    fill(now, clockWords(at_s));
    const found = foundByNow();
    fill(share, found === null ? "" : `Found by then, if it is there: ${percent(found, 0)} of what was left at take-off; drawn is what is still to be found.`);
    const usual = palette().collect;
    fill(list, ...all.map((flight) => h("li", { style: `--c:${colours.get(flight.vehicle) ?? usual}` }, `${nameOf(flight, all)}: ${doing(flight, at_s)}`)));
    fill(near, all.length > 1 ? nearest(all, at_s) : "");
  };
  flights.watch(draw);
  clock_s.watch(tell);
  looked.watch(tell);
  onThemeChange(draw);
  return box;
}
