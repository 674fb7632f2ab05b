"""What is wrong with a plan, by geometry of the tests' own: nothing here comes from the planner.

Places are projected azimuthally equidistant from the scenario's middle; turns are circles through three
vertices; zones, areas and straight runs are shapely's; what a pass sees is asked point by point, by the
angles between antenna and ray.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from pyproj import Geod, Transformer
from shapely.geometry import LineString, MultiPolygon, Point, Polygon
from shapely.geometry.base import BaseGeometry

Floats = NDArray[np.float64]

GEOD = Geod(ellps="WGS84")
#: Straight flight is looked at in places so far apart.
STEP_M = 2.0
#: Projections and rounding move places by this part of their distance from the middle, and by centimetres.
PLACE_M, PLACE_PART = 0.1, 2e-5
EARTH_M = 6.37e6
#: Points of a region looked at.
LOOKED_AT = 250


@dataclass(frozen=True, slots=True)
class Ground:
    """A scenario document on the plane."""

    document: dict[str, Any]
    frame: Transformer
    slack_m: float

    @classmethod
    def of(cls, document: dict[str, Any]) -> Ground:
        """The plane round the middle of all features."""
        shapes = [shapely.geometry.shape(feature["geometry"]) for feature in document["features"]]
        west, south, east, north = shapely.unary_union([shape.envelope for shape in shapes]).bounds
        middle = f"+proj=aeqd +lat_0={(south + north) / 2.0} +lon_0={(west + east) / 2.0} +datum=WGS84"
        frame = Transformer.from_crs("EPSG:4326", middle, always_xy=True)
        far_m = GEOD.inv(west, south, east, north)[2] / 2.0
        # Off the middle any two projections differ in scale: by so much over what is seen at once.
        stretched_m = (far_m / EARTH_M) ** 2 / 2.0 * 3.0 * document["altitude_m"]
        return cls(document, frame, PLACE_M + PLACE_PART * far_m + stretched_m)

    def places(self, lonlats: Any) -> Floats:
        """Shape (N, 2), east and north."""
        array = np.asarray([place[:2] for place in lonlats], dtype=np.float64)
        return np.stack(self.frame.transform(array[:, 0], array[:, 1]), axis=1)

    def ring(self, lonlats: Any) -> Floats:
        """A ring whose edges are straight in longitude and latitude."""
        fine = shapely.segmentize(LineString([place[:2] for place in lonlats]), 0.001)
        return self.places(shapely.get_coordinates(fine))

    def polygon(self, rings: Any) -> Polygon:
        return Polygon(self.ring(rings[0]), [self.ring(ring) for ring in rings[1:]])

    def shape(self, feature: dict[str, Any]) -> BaseGeometry:
        """The ground a feature means."""
        kind, coordinates = feature["geometry"]["type"], feature["geometry"]["coordinates"]
        properties = feature["properties"]
        if kind == "Polygon":
            return self.polygon(coordinates)
        if kind == "MultiPolygon":
            return MultiPolygon([self.polygon(rings) for rings in coordinates])
        if kind == "LineString":
            return LineString(self.places(coordinates)).buffer(properties["width_m"] / 2.0, cap_style="flat")
        place = Point(self.places([coordinates])[0])
        return place.buffer(properties.get("radius_m") or 1.0, quad_segs=32)

    def of_role(self, role: str) -> list[dict[str, Any]]:
        return [feature for feature in self.document["features"] if feature["properties"]["role"] == role]


def home_m(ground: Ground) -> float:
    """Height of home above the sea."""
    return float(ground.of_role("start")[0]["geometry"]["coordinates"][2])


def heights_m(ground: Ground) -> tuple[float, float]:
    """Flight height over the ground, which is level, and above the sea."""
    altitude_m = ground.document["altitude_m"]
    if ground.document.get("altitude_reference", "terrain") == "amsl":
        return altitude_m - home_m(ground), altitude_m
    return altitude_m, altitude_m + home_m(ground)


def hard_zones(ground: Ground) -> dict[str, BaseGeometry]:
    """What may never be entered at the flight's height, with what is kept from it all round."""
    height_m, amsl_m = heights_m(ground)
    clear_m = kept_m(ground.document)
    zones: dict[str, BaseGeometry] = {}
    for feature in ground.document["features"]:
        properties, name = feature["properties"], feature["id"]
        low_m, high_m, flown_m = -math.inf, -math.inf, height_m
        if properties["role"] == "threat" and properties.get("hard"):
            high_m = properties.get("height_m", math.inf)
        elif properties["role"] == "no_fly":
            low_m, high_m, flown_m = properties.get("floor_m", -math.inf), math.inf, amsl_m
            high_m = properties.get("ceiling_m", math.inf)
        elif properties["role"] == "obstacle":
            high_m = properties["height_m"] + properties.get("base_m", 0.0)
        if low_m - clear_m <= flown_m <= high_m + clear_m:
            zones[name] = ground.shape(feature).buffer(clear_m)
    return zones


def kept_m(document: dict[str, Any]) -> float:
    """What is kept from everything hard: as stated, else what the autopilot is flown off its line."""
    vehicle = document["vehicles"][0]
    wing = {"ardupilot": 30.0, "px4": 20.0}[vehicle.get("autopilot", "ardupilot")]
    default_m = 5.0 if vehicle.get("type") == "multirotor" else wing
    return float(document.get("clearance_m", default_m))


def wind_m_s(ground: Ground) -> Floats:
    """Velocity of the air, east and north."""
    wind = ground.document.get("wind") or {"speed_m_s": 0.0, "from_deg": 0.0}
    toward = math.radians(wind["from_deg"] + 180.0)
    return wind["speed_m_s"] * np.array([math.sin(toward), math.cos(toward)])


def faults(document: dict[str, Any], plan: dict[str, Any]) -> list[str]:
    """Everything wrong with a plan for a scenario, both as GeoJSON; empty for a sound one."""
    ground = Ground.of(document)
    paths = [f for f in plan["features"] if f["properties"]["role"] == "path"]
    over = ("range", "flight-time", "energy")
    found = [
        f"hard violation {v['constraint']}: {v['message']}"
        for v in plan["violations"]
        if v["hard"] and v["constraint"] not in over
    ]
    if len(paths) != 1:
        return [*found, f"{len(paths)} paths"]
    line_m = ground.places(paths[0]["geometry"]["coordinates"])
    line = LineString(line_m)
    found += _ends(ground, line_m, plan["vehicles"][0])
    found += _turns(ground, line_m)
    found += _places(ground, line)
    found += _lengths(paths[0], plan)
    collects = [f for f in plan["features"] if f["properties"]["role"] == "collect"]
    found += _straight(ground, line, collects)
    found += _limits(ground, paths[0], plan)
    found += _seen(ground, plan, collects)
    return found


def _ends(ground: Ground, line_m: Floats, vehicle: dict[str, Any]) -> list[str]:
    """The path goes from start to end, in their directions; over the end where it returns or circles."""
    start = ground.of_role("start")[0]
    ends = ground.of_role("end")
    end = ends[0] if ends else {**start, "properties": {"role": "end"}}
    edges = np.diff(line_m, axis=0)
    edges = edges[np.hypot(*edges.T) > 1e-3]
    places = [(start, line_m[0], edges[0])]
    found = []
    if vehicle["finish"] == "land" or (vehicle["finish"], vehicle["type"]) == ("loiter", "multirotor"):
        places.append((end, line_m[-1], edges[-1]))
    else:
        over = Point(ground.places([end["geometry"]["coordinates"]])[0])
        gap_m = LineString(line_m).distance(over)
        home_m = math.dist(line_m[-1], line_m[0])
        if vehicle["type"] != "multirotor" and gap_m > ground.slack_m:
            found.append(f"end missed by {gap_m:.2f} m")
        if vehicle["finish"] == "return" and home_m > 2.0 * turn_radius_m(ground) + 10.0:
            found.append(f"end missed: {home_m:.2f} m from home after the return")
    for feature, place, edge in places:
        gap_m = math.dist(place, ground.places([feature["geometry"]["coordinates"]])[0])
        if gap_m > ground.slack_m:
            found.append(f"{feature['properties']['role']} missed by {gap_m:.2f} m")
        heading = feature["properties"].get("heading_deg")
        if heading is None:
            continue
        lon, lat = feature["geometry"]["coordinates"][:2]
        ahead = ground.places([GEOD.fwd(lon, lat, heading, 100.0)[:2]])[0] - place
        off = math.remainder(math.atan2(edge[1], edge[0]) - math.atan2(ahead[1], ahead[0]), math.tau)
        edge_m = math.hypot(*edge)
        half_turn = edge_m / (2.0 * turn_radius_m(ground)) if edge_m <= 10.0 else 0.0
        if abs(off) > half_turn + math.radians(0.7):
            found.append(f"heading off by {math.degrees(off):.2f}° at {feature['properties']['role']}")
    return found


def turn_radius_m(ground: Ground) -> float:
    """The tightest turn over the ground: of the bank that the tightest in still air has, downwind.

    Multirotors hold their speed over the ground: theirs is the same in any wind.
    """
    vehicle = ground.document["vehicles"][0]
    if vehicle.get("type") == "multirotor":
        return float(vehicle["min_turn_radius_m"])
    share = math.hypot(*wind_m_s(ground)) / vehicle["airspeed_m_s"]
    return float(vehicle["min_turn_radius_m"] * (1.0 + share) ** 2)


def _turns(ground: Ground, line_m: Floats) -> list[str]:
    """No three vertices on a tighter circle; no kinks between straights."""
    steps = np.hypot(*np.diff(line_m, axis=0).T)
    line_m = line_m[np.concatenate([[True], steps > 1e-3])]
    one, two = line_m[1:-1] - line_m[:-2], line_m[2:] - line_m[1:-1]
    long_one, long_two = np.hypot(*one.T), np.hypot(*two.T)
    turned = np.abs(np.arctan2(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0], (one * two).sum(axis=1)))
    # A circle of the least radius turns so much from the middle of a chord to the middle of the next; an edge
    # longer than any chord is straight and turns nothing but what half a chord may.
    half_one, half_two = np.minimum(long_one, 10.0) / 2.0, np.minimum(long_two, 10.0) / 2.0
    radius_m = turn_radius_m(ground)
    allowed = np.arcsin(np.minimum(half_one / radius_m, 1.0)) + np.arcsin(
        np.minimum(half_two / radius_m, 1.0)
    )
    over = turned - allowed - 4e-5 - 0.003 / np.minimum(long_one, long_two) * 0.01
    worst = int(np.argmax(over))
    if over[worst] <= 1e-3 * allowed[worst]:
        return []
    return [
        f"turn of {math.degrees(turned[worst]):.2f}° where {math.degrees(allowed[worst]):.2f}° are flyable"
    ]


def _places(ground: Ground, line: LineString) -> list[str]:
    """Inside the area, outside hard zones."""
    found = []
    for feature in ground.of_role("area"):
        outside = line.difference(ground.shape(feature).buffer(ground.slack_m))
        if not outside.is_empty:
            found.append(f"{outside.length:.1f} m outside the area")
    for name, zone in hard_zones(ground).items():
        inside = line.intersection(zone.buffer(-ground.slack_m))
        if not inside.is_empty:
            found.append(f"{inside.length:.1f} m inside {name}")
    return found


def _lengths(path: dict[str, Any], plan: dict[str, Any]) -> list[str]:
    """Length by geodesics between the vertices, and their heights."""
    lons, lats, altitudes_m = np.array(path["geometry"]["coordinates"]).T
    length_m = float(np.hypot(GEOD.line_lengths(lons, lats), np.diff(altitudes_m)).sum())
    said_m = path["properties"]["length_m"]
    if abs(said_m - length_m) > 1.5e-3 * length_m:
        return [f"length {said_m:.0f} m, measured {length_m:.0f} m"]
    return []


def _straight(ground: Ground, line: LineString, collects: list[dict[str, Any]]) -> list[str]:
    """Each collect on the path, and the straight flight wanted before it."""
    vehicle = ground.document["vehicles"][0]
    faster = 1.0 + math.hypot(*wind_m_s(ground)) / vehicle["airspeed_m_s"]
    settle_m = vehicle.get("settle_m", 0.0) * faster
    shapely.prepare(line)
    found = []
    for collect in collects:
        start, end = ground.places(collect["geometry"]["coordinates"])
        begin = start - settle_m * (end - start) / math.dist(start, end)
        flown = LineString([begin, end])
        places = shapely.points(shapely.get_coordinates(shapely.segmentize(flown, STEP_M)))
        if not shapely.dwithin(line, places, 2.0 * ground.slack_m).all():
            found.append(f"collect {collect['properties']['seq']} or its settling run is off the path")
    return found


def _limits(ground: Ground, path: dict[str, Any], plan: dict[str, Any]) -> list[str]:
    """Range, time and energy are kept unless all that is not required is left out, and then that is said."""
    vehicle, said = ground.document["vehicles"][0], path["properties"]
    energy_wh = vehicle.get("energy_wh")
    limits = {
        "range": (said["length_m"], vehicle.get("max_range_m")),
        "flight-time": (said["duration_s"], vehicle.get("max_flight_time_s")),
        "energy": (
            said["energy_wh"],
            None if energy_wh is None else energy_wh * (1.0 - vehicle.get("reserve", 0.2)),
        ),
    }
    optional = {f["id"] for f in ground.of_role("roi") if not f["properties"].get("required", True)}
    blamed = {violation["constraint"] for violation in plan["violations"]}
    found = []
    for name, (used, limit) in limits.items():
        if limit is None or used <= limit * (1.0 + 1e-9):
            continue
        if optional - {each["roi"] for each in plan["metrics"]["left_out"]}:
            found.append(f"{name} {used:.0f} over {limit:.0f} with regions that need not be seen")
        if name not in blamed:
            found.append(f"{name} {used:.0f} over {limit:.0f} unsaid")
    return found


def _seen(ground: Ground, plan: dict[str, Any], collects: list[dict[str, Any]]) -> list[str]:
    """Every place of every region in the beam for a whole aperture, as often as asked."""
    left_out = {each["roi"] for each in plan["metrics"].get("left_out", [])}
    left_out |= {f["properties"]["roi"] for f in plan["features"] if f["properties"]["role"] == "uncovered"}
    found = []
    for feature in ground.of_role("roi"):
        properties, name = feature["properties"], feature["id"]
        if name in left_out and not properties.get("required", True):
            continue
        places = _looked_at(ground.shape(feature).buffer(-ground.slack_m) or ground.shape(feature))
        times = np.zeros(len(places))
        for collect in collects:
            if _counts(ground, properties, collect):
                times += sees(ground, collect, places)
        missed = times < properties.get("revisits", 1)
        if missed.any():
            found.append(f"{int(missed.sum())} of {len(places)} places of {name} not seen")
    return found


def _looked_at(shape: BaseGeometry) -> Floats:
    """Corners, and places all over, of a shape."""
    if shape.is_empty:
        return np.empty((0, 2))
    low_e, low_n, high_e, high_n = shape.bounds
    rng = np.random.default_rng(1)
    count = int(LOOKED_AT * (high_e - low_e) * (high_n - low_n) / shape.area) + 1
    drawn = rng.uniform((low_e, low_n), (high_e, high_n), (min(count, 20 * LOOKED_AT), 2))
    inside = shapely.contains_xy(shape, drawn[:, 0], drawn[:, 1])
    return np.concatenate([drawn[inside], shapely.get_coordinates(shape)])


def sensor_of(ground: Ground, name: str | None) -> dict[str, Any]:
    """The sensor of a name, else the first."""
    sensors = ground.document["sensors"]
    return next((each for each in sensors if each["name"] == name), sensors[0])


def _counts(ground: Ground, properties: dict[str, Any], collect: dict[str, Any]) -> bool:
    if collect["properties"]["sensor"] != sensor_of(ground, properties.get("sensor"))["name"]:
        return False
    approach = properties.get("approach_deg")
    heading = collect["properties"]["heading_deg"]
    return approach is None or any(abs((heading - each + 180.0) % 360.0 - 180.0) < 1.1 for each in approach)


def sees(ground: Ground, collect: dict[str, Any], places: Floats) -> NDArray[np.bool_]:
    """Which places one collect sees.

    The antenna's axis lies along the nose, which points along the velocity through the air; a place is passed
    where the ray to it leaves the axis' normal by the squint. There it must lie between the edges of the
    elevation beam, on the side looked to, and half an aperture or more from sensor on and off.
    """
    sensor = sensor_of(ground, collect["properties"]["sensor"])
    height_m, _ = heights_m(ground)
    start, end = ground.places(collect["geometry"]["coordinates"])
    length_m = math.dist(start, end)
    ahead = (end - start) / length_m
    wind, airspeed_m_s = wind_m_s(ground), ground.document["vehicles"][0]["airspeed_m_s"]
    crabs = math.hypot(*wind) > 0.0 and not sensor.get("stabilised", False)
    nose = ahead
    if crabs:
        tail = float(ahead @ wind)
        speed_m_s = tail + math.sqrt(tail**2 + airspeed_m_s**2 - float(wind @ wind))
        nose = (speed_m_s * ahead - wind) / airspeed_m_s
    out = np.array([nose[1], -nose[0]]) * (1.0 if collect["properties"]["look"] == "right" else -1.0)
    squint_tan = math.tan(math.radians(sensor.get("squint_deg", 0.0)))

    def off(along_m: Floats) -> tuple[Floats, Floats]:
        ray = places - start - along_m[:, None] * ahead
        across = ray @ out
        return ray @ nose - squint_tan * np.hypot(across, height_m), across

    low, high = (
        np.full(len(places), -20.0 * length_m - 20.0 * height_m),
        np.full(len(places), 21.0 * length_m + 20.0 * height_m),
    )
    for _ in range(60):
        middle = (low + high) / 2.0
        ahead_of = off(middle)[0] > 0.0
        low, high = np.where(ahead_of, middle, low), np.where(ahead_of, high, middle)
    along_m = (low + high) / 2.0
    look_deg = np.degrees(np.arctan2(off(along_m)[1], height_m))
    half_deg = sensor["elevation_beamwidth_deg"] * sensor.get("sub_swaths", 1) / 2.0
    middle_deg = sensor["incidence_deg"]
    slack_deg = math.degrees(ground.slack_m / height_m) + 1e-6
    in_beam = np.abs(look_deg - middle_deg) <= half_deg + slack_deg
    half_m = (
        height_m * math.radians(sensor["azimuth_beamwidth_deg"]) / math.cos(math.radians(middle_deg)) / 2.0
    )
    # Turned or squinted antennas pass the ground at other rates: half the time is asked of them.
    half_m *= 0.5 if crabs or squint_tan != 0.0 else 1.0
    lit = (along_m >= half_m - ground.slack_m) & (along_m <= length_m - half_m + ground.slack_m)
    return np.asarray(in_beam & lit, dtype=np.bool_)
