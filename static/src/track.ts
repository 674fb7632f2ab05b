/** The flown track as it comes in: kept short enough to draw, cut where the sensor was switched. */
import type { Feature, LineString } from "geojson";
import { distance_m } from "./geo";
import type { Position } from "./types";

export interface TrackPoint {
  at: Position;
  sensor_on: boolean;
  /** The vehicle's own time since boot, where it tells one. */
  time_s: number | null;
}

const LEAST_STEP_M = 4;
const MOST_POINTS = 40_000;

export class Track {
  #points: TrackPoint[] = [];

  get points(): readonly TrackPoint[] {
    return this.#points;
  }

  /** Add a place, unless the aircraft has hardly moved and the sensor is as it was. */
  add(point: TrackPoint): boolean {
    const last = this.#points.at(-1);
    if (last && last.sensor_on === point.sensor_on && distance_m(last.at, point.at) < LEAST_STEP_M) return false;
    this.#points.push(point);
    if (this.#points.length > MOST_POINTS) this.#points = this.#points.filter((_, index) => index % 2 === 0);
    return true;
  }

  /** Put what was recorded before this page looked in front of what it saw itself. */
  precede(recorded: TrackPoint[]): void {
    const first_s = this.#points[0]?.time_s ?? null;
    const before = first_s === null ? recorded : recorded.filter(({ time_s }) => time_s === null || time_s < first_s);
    const seen = this.#points;
    this.#points = [];
    for (const point of [...before, ...seen]) this.add(point);
  }

  clear(): void {
    this.#points = [];
  }

  /** Lines of one sensor state each, joined end to start. */
  features(): Feature<LineString>[] {
    const lines: Feature<LineString>[] = [];
    let coordinates: Position[] = [];
    let state: boolean | null = null;
    const close = (): void => {
      if (coordinates.length > 1) {
        lines.push({ type: "Feature", properties: { sensor_on: state === true }, geometry: { type: "LineString", coordinates } });
      }
    };
    for (const point of this.#points) {
      if (point.sensor_on !== state) {
        const join = coordinates.at(-1);
        close();
        coordinates = join ? [join] : [];
        state = point.sensor_on;
      }
      coordinates.push(point.at);
    }
    close();
    return lines;
  }
}
