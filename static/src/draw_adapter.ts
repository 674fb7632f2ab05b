/** What terra-draw sees of the map: a world turned so that what is drawn lies far from its cut at ±180°. */
import type { Geometry } from "geojson";
import type { Map as MapLibreMap } from "maplibre-gl";
import type { GeoJSONStoreFeatures } from "terra-draw";
import { TerraDrawMapLibreGLAdapter } from "terra-draw-maplibre-gl-adapter";
import { mapLongitudes, nearTo, unwrap } from "./antimeridian";

type Changes = Parameters<TerraDrawMapLibreGLAdapter<MapLibreMap>["render"]>[0];
type Styling = Parameters<TerraDrawMapLibreGLAdapter<MapLibreMap>["render"]>[1];

/** As many digits as a coordinate may have there. */
const DIGITS = 9;
const round = (lon_deg: number): number => Math.round(lon_deg * 10 ** DIGITS) / 10 ** DIGITS;

export class TurnedAdapter extends TerraDrawMapLibreGLAdapter<MapLibreMap> {
  readonly #turned: MapLibreMap;
  #middle_deg = 0;

  constructor(map: MapLibreMap) {
    super({ map, coordinatePrecision: DIGITS });
    this.#turned = map;
  }

  /** Put a meridian into the middle of the drawn world; only while nothing is drawn in it. */
  turnTo(lon_deg: number): void {
    this.#middle_deg = Math.round(lon_deg);
  }

  /** A geometry of the scenario as it is drawn, in one piece; and back. */
  inside<G extends Geometry>(geometry: G): G {
    const whole = unwrap(geometry);
    const [first] = longitudes(whole);
    const turn_deg = nearTo((first ?? 0) - this.#middle_deg, 0) - (first ?? 0);
    return mapLongitudes(whole, (lon) => round(lon + turn_deg)) as G;
  }

  outside<G extends Geometry>(geometry: G): G {
    return mapLongitudes(geometry, (lon) => lon + this.#middle_deg) as G;
  }

  override project(lon_deg: number, lat_deg: number): { x: number; y: number } {
    return super.project(nearTo(lon_deg + this.#middle_deg, this.#turned.getCenter().lng), lat_deg);
  }

  override unproject(x: number, y: number): { lng: number; lat: number } {
    const { lng, lat } = super.unproject(x, y);
    return { lng: nearTo(lng - this.#middle_deg, 0), lat };
  }

  override render(changes: Changes, styling: Styling): void {
    const out = (features: GeoJSONStoreFeatures[]): GeoJSONStoreFeatures[] => features.map((feature) => ({ ...feature, geometry: this.outside(feature.geometry) }));
    super.render({ ...changes, created: out(changes.created), updated: out(changes.updated), unchanged: out(changes.unchanged) }, styling);
  }
}

function longitudes(geometry: Geometry): number[] {
  const found: number[] = [];
  mapLongitudes(geometry, (lon) => {
    found.push(lon);
    return lon;
  });
  return found;
}
