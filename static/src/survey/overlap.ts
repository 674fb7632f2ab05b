/** How many photos see each place: counted on a grid that is even on the screen, and what of the regions it makes. */
import type { Geometry } from "geojson";
import { nearTo } from "../antimeridian";
import { boundsOf, type Bounds } from "../geo";
import type { Position } from "../types";

const RAD = Math.PI / 180;
const MOST_CELLS_A_SIDE = 800;
const LEAST_CELL_M = 1;
const METRES_A_DEGREE = 111_195;
const OPAQUE = 255;

/** Classes of how many photos see a place: from this many on. */
export const CLASSES = [
  { from: 1, label: "1", colour: "#8b1a4a" },
  { from: 2, label: "2", colour: "#d95f0e" },
  { from: 3, label: "3 to 4", colour: "#f2c744" },
  { from: 5, label: "5 to 8", colour: "#7cc08a" },
  { from: 9, label: "9 or more", colour: "#3f8fb5" },
] as const;

export const mercator = (lat_deg: number): number => Math.log(Math.tan(Math.PI / 4 + (lat_deg * RAD) / 2)) / RAD;

export interface Overlap {
  bounds: Bounds;
  columns: number;
  rows: number;
  /** Rows from the north, each of equal height on the screen. */
  counts: Uint16Array;
  cell_m: number;
}

/** Count photos by cells whose middles they see; null where there are none. */
export function overlapOf(prints: Position[][]): Overlap | null {
  const around = boundsOf(prints.map((ring) => ({ geometry: { type: "LineString", coordinates: ring } })));
  if (!around) return null;
  const [west, south, east, north] = around;
  const middle = (west + east) / 2;
  const [top, bottom] = [mercator(north), mercator(south)];
  const a_degree_m = METRES_A_DEGREE * Math.cos(((south + north) / 2) * RAD);
  const cell_m = Math.max(LEAST_CELL_M, (Math.max(east - west, top - bottom) * a_degree_m) / MOST_CELLS_A_SIDE);
  const columns = Math.max(1, Math.ceil(((east - west) * a_degree_m) / cell_m));
  const rows = Math.max(1, Math.ceil(((top - bottom) * a_degree_m) / cell_m));
  const counts = new Uint16Array(columns * rows);
  const x = (lon: number): number => ((nearTo(lon, middle) - west) / (east - west)) * columns;
  const y = (lat: number): number => ((top - mercator(lat)) / (top - bottom)) * rows;
  for (const ring of prints) {
    const xs = ring.map(([lon]) => x(lon));
    const ys = ring.map(([, lat]) => y(lat));
    const last = Math.min(rows - 1, Math.floor(Math.max(...ys) - 0.5));
    for (let row = Math.max(0, Math.ceil(Math.min(...ys) - 0.5)); row <= last; row += 1) {
      const [from, to] = crossed(xs, ys, row + 0.5);
      const end = Math.min(columns - 1, Math.floor(to - 0.5));
      for (let column = Math.max(0, Math.ceil(from - 0.5)); column <= end; column += 1) counts[row * columns + column] = (counts[row * columns + column] as number) + 1;
    }
  }
  return { bounds: around, columns, rows, counts, cell_m };
}

/** Where a level line enters and leaves a convex ring. */
function crossed(xs: number[], ys: number[], level: number): [number, number] {
  let [from, to] = [Infinity, -Infinity];
  for (let i = 0; i < xs.length; i += 1) {
    const k = (i + 1) % xs.length;
    const [y0, y1] = [ys[i] as number, ys[k] as number];
    if (y0 === y1 || level < Math.min(y0, y1) || level > Math.max(y0, y1)) continue;
    const at = (xs[i] as number) + (((xs[k] as number) - (xs[i] as number)) * (level - y0)) / (y1 - y0);
    from = Math.min(from, at);
    to = Math.max(to, at);
  }
  return [from, to];
}

/** How many photos see a place. */
export function countAt({ bounds: [west, south, east, north], columns, rows, counts }: Overlap, [lon, lat]: Position): number {
  const column = Math.floor(((nearTo(lon, (west + east) / 2) - west) / (east - west)) * columns);
  const row = Math.floor(((mercator(north) - mercator(lat)) / (mercator(north) - mercator(south))) * rows);
  return column < 0 || row < 0 || column >= columns || row >= rows ? 0 : (counts[row * columns + column] as number);
}

/** The picture of an overlap, a pixel a cell. */
export function pictureOf({ columns, rows, counts }: Overlap): HTMLCanvasElement {
  const canvas = canvasOf(columns, rows);
  const context = contextOf(canvas);
  const image = context.createImageData(columns, rows);
  const colours = CLASSES.map(({ colour }) => [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16)));
  for (let cell = 0; cell < counts.length; cell += 1) {
    const colour = colours[classOf(counts[cell] as number)];
    if (!colour) continue;
    for (let part = 0; part < 3; part += 1) image.data[cell * 4 + part] = colour[part] as number;
    image.data[cell * 4 + 3] = OPAQUE;
  }
  context.putImageData(image, 0, 0);
  return canvas;
}

/** The class of a count; −1 where no photo sees it. */
export function classOf(count: number): number {
  let found = CLASSES.length - 1;
  while (found >= 0 && count < (CLASSES[found] as { from: number }).from) found -= 1;
  return found;
}

/** The corners of the picture on the map, from the north-west, clockwise. */
export function cornersOf({ bounds: [west, south, east, north] }: Overlap): [Position, Position, Position, Position] {
  return [[west, north], [east, north], [east, south], [west, south]];
}

export interface Shares {
  /** Of the regions' ground, the part seen by as many photos as each class asks for at least. */
  atLeast: number[];
  unseen: number;
  least: number;
}

/** What part of outlines is seen how often; null where they cover no cell. */
export function sharesOf(overlap: Overlap, outlines: Geometry[]): Shares | null {
  const { bounds: [west, south, east, north], columns, rows, counts } = overlap;
  const own = boundsOf(outlines.map((geometry) => ({ geometry })));
  if (!own) return null;
  // The regions may reach beyond all photos: what is not on the grid is not seen.
  const wide = Math.ceil(((own[2] - own[0]) / (east - west)) * columns);
  const high = Math.ceil(((mercator(own[3]) - mercator(own[1])) / (mercator(north) - mercator(south))) * rows);
  if (wide < 1 || high < 1 || wide * high > 4 * MOST_CELLS_A_SIDE ** 2) return null;
  const context = contextOf(canvasOf(wide, high));
  const middle = (own[0] + own[2]) / 2;
  const put = ([lon, lat]: number[]): [number, number] => [
    ((nearTo(lon as number, middle) - own[0]) / (own[2] - own[0])) * wide,
    ((mercator(own[3]) - mercator(lat as number)) / (mercator(own[3]) - mercator(own[1]))) * high,
  ];
  const path = new Path2D();
  for (const geometry of outlines) {
    const polygons = geometry.type === "Polygon" ? [geometry.coordinates] : geometry.type === "MultiPolygon" ? geometry.coordinates : [];
    for (const ring of polygons.flat()) ring.forEach((place, i) => (i === 0 ? path.moveTo(...put(place)) : path.lineTo(...put(place))));
  }
  context.fill(path, "evenodd");
  const mask = context.getImageData(0, 0, wide, high).data;
  const at = (share: number, from: number, to: number): number => from + share * (to - from);
  const columnOf = Array.from({ length: wide }, (_, i) => Math.floor(((nearTo(at((i + 0.5) / wide, own[0], own[2]), (west + east) / 2) - west) / (east - west)) * columns));
  const rowOf = Array.from({ length: high }, (_, i) => Math.floor(((mercator(north) - at((i + 0.5) / high, mercator(own[3]), mercator(own[1]))) / (mercator(north) - mercator(south))) * rows));
  const atLeast = CLASSES.map(() => 0);
  let [all, unseen, least] = [0, 0, Infinity];
  for (let i = 0; i < wide * high; i += 1) {
    // Cells across the outline are of what lies outside as well.
    if (mask[i * 4 + 3] !== OPAQUE) continue;
    const [row, column] = [rowOf[Math.floor(i / wide)] as number, columnOf[i % wide] as number];
    const count = row < 0 || column < 0 || row >= rows || column >= columns ? 0 : (counts[row * columns + column] as number);
    all += 1;
    least = Math.min(least, count);
    if (count === 0) unseen += 1;
    CLASSES.forEach(({ from }, index) => count >= from && (atLeast[index] = (atLeast[index] as number) + 1));
  }
  return all === 0 ? null : { atLeast: atLeast.map((cells) => cells / all), unseen: unseen / all, least };
}

function canvasOf(width: number, height: number): HTMLCanvasElement {
  const canvas = document.createElement("canvas");
  canvas.width = width;
  canvas.height = height;
  return canvas;
}

function contextOf(canvas: HTMLCanvasElement): CanvasRenderingContext2D {
  const context = canvas.getContext("2d", { willReadFrequently: true });
  if (!context) throw new Error("this browser draws no canvas");
  return context;
}
