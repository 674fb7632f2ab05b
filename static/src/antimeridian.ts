/** Lines across ±180° without the jump. The map draws longitudes beyond ±180° where they belong. */
import type { Geometry, Position as GeoPosition } from "geojson";

/** The name of the same meridian that is nearest to another longitude. */
export function nearTo(lon_deg: number, reference_deg: number): number {
  return lon_deg + 360 * Math.round((reference_deg - lon_deg) / 360);
}

/** A longitude as GeoJSON wants it, from −180 to 180. */
export function within180(lon_deg: number): number {
  return lon_deg >= -180 && lon_deg <= 180 ? lon_deg : lon_deg - 360 * Math.floor((lon_deg + 180) / 360);
}

/** A line in which each longitude is the nearest to the one before it; the first one to `reference_deg`. */
export function unwrapLine(line: GeoPosition[], reference_deg?: number): GeoPosition[] {
  let before = reference_deg ?? line[0]?.[0] ?? 0;
  return line.map(([lon, ...rest]) => {
    before = nearTo(lon as number, before);
    return [before, ...rest];
  });
}

/** A polygon's rings, the holes inside the outer ring's turn of the world. */
export function unwrapRings([outer, ...holes]: GeoPosition[][]): GeoPosition[][] {
  if (!outer) return [];
  const whole = unwrapLine(outer);
  const lons = whole.map(([lon]) => lon as number);
  const middle = (Math.min(...lons) + Math.max(...lons)) / 2;
  return [whole, ...holes.map((hole) => unwrapLine(hole, middle))];
}

/** The same geometry with every line of it in one piece. */
export function unwrap(geometry: Geometry): Geometry {
  switch (geometry.type) {
    case "LineString":
      return { ...geometry, coordinates: unwrapLine(geometry.coordinates) };
    case "MultiLineString":
      return { ...geometry, coordinates: geometry.coordinates.map((line) => unwrapLine(line)) };
    case "Polygon":
      return { ...geometry, coordinates: unwrapRings(geometry.coordinates) };
    case "MultiPolygon":
      return { ...geometry, coordinates: geometry.coordinates.map(unwrapRings) };
    case "GeometryCollection":
      return { ...geometry, geometries: geometry.geometries.map(unwrap) };
    default:
      return geometry;
  }
}

/** The same geometry with every longitude changed. */
export function mapLongitudes(geometry: Geometry, change: (lon_deg: number) => number): Geometry {
  if (geometry.type === "GeometryCollection") return { ...geometry, geometries: geometry.geometries.map((part) => mapLongitudes(part, change)) };
  const walk = (value: unknown): unknown => {
    if (!Array.isArray(value)) return value;
    return typeof value[0] === "number" ? [change(value[0]), ...(value.slice(1) as number[])] : value.map(walk);
  };
  return { ...geometry, coordinates: walk(geometry.coordinates) } as Geometry;
}
