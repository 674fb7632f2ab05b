"""Vehicles, sensors and the other foreign members of a scenario."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from planner.airspace.values import Wind
from planner.frames import LocalFrame
from planner.geojson.fields import Fields, Findings
from planner.geojson.power import read_power
from planner.sensors.base import Sensor
from planner.sensors.registry import KINDS
from planner.vehicle.aircraft import (
    CORNER_RADIUS_M,
    DEFAULT_RESERVE,
    MOST_ITEMS,
    Aircraft,
    Aloft,
    turn_radius_from_bank_m,
    turn_radius_from_load_factor_m,
)
from planner.vehicle.airframes import completed, find_airframe, is_airframe
from planner.vehicle.steadiness import Steadiness, steadiness_of
from planner.wishes import Method, Objective

#: No aircraft is thought higher over its home.
HIGHEST_ALOFT_M = 30_000.0
#: Of a mission: enough for a few passes with their turns.
LEAST_ITEMS = 20
#: Arcs of less are points.
LEAST_RADIUS_M = 0.001
VEHICLE_TYPES = ("fixed_wing", "multirotor", "vtol")
AUTOPILOTS = ("ardupilot", "px4")

#: Patterns of search, refined ones, walks over importance and the horizon on energy, asked for by name.
FAMILIES = (
    "parallel", "creeping", "spiral", "square", "sector", "refined", "importance", "snyder2021",
    "energy-horizon", "energy-horizon-discrete", "energy-horizon-no-decision", "energy-horizon-time",
)  # fmt: skip
#: Ways of coverage whose sweeps come in order.
OWN_ORDER = ("majeed2019", "boustrophedon-cells", "coverage-alternatives")

#: Of a disc's linearisation in ``transit`` ``milp``: a 124-gon then.
MOST_DIRECTIONS = 32

METHODS = {
    "coverage": ("auto", "li2018", *OWN_ORDER),
    "routing": ("auto", "joint", "li2018", "li2018-threat-aware", "stecz2020"),
    "transit": ("auto", "ssas", "tangent", "milp", "milp-length"),
    "smoothing": ("auto", "fillet", "shortcut", "three-arc", "past-target", "short-turn"),
    "search": ("auto", *FAMILIES),
}


def read_aircraft(raw: Any, index: int, findings: Findings) -> Aircraft | None:
    """One entry of ``vehicles``."""
    if not isinstance(raw, dict):
        findings.error("scenario", "bad-value", f"vehicles[{index}] is not an object", "Give an object.")
        return None
    name = raw.get("name")
    owner = f"vehicle {name if name else index}"
    raw = _of_model(raw, Fields(owner, raw, findings))
    fields = Fields(owner, raw, findings)
    fields.raw("model")
    name = fields.text("name")
    kind: Any = fields.choice("type", VEHICLE_TYPES, "fixed_wing")
    autopilot: Any = fields.choice("autopilot", AUTOPILOTS, "ardupilot")
    airspeed_m_s = fields.number("airspeed_m_s", above=0.0, maximum=400.0)
    slowest_m_s = fields.number("min_airspeed_m_s", None, above=0.0, maximum=airspeed_m_s or 400.0)
    radius_m = _turn_radius_m(fields, airspeed_m_s, kind)
    max_climb_deg = fields.number("max_climb_deg", 8.0, above=0.0, below=90.0)
    energy_wh, voltage_v = _stored_wh(fields)
    power = read_power(fields, findings, kind)
    reserve = fields.number("reserve", DEFAULT_RESERVE, minimum=0.0, below=1.0)
    range_m = fields.number("max_range_m", None, above=0.0)
    time_s = fields.number("max_flight_time_s", None, above=0.0)
    steady = named_steadiness(raw)
    steady_m = 0.0 if steady is None or airspeed_m_s is None else steady.settle_s * airspeed_m_s
    settle_m = fields.number("settle_m", steady_m, minimum=0.0)
    base = fields.text("base", None)
    end_bases = _names(fields, "end_bases", "bases, or leave it out to land where it starts")
    sensors = _names(fields, "sensors", "sensors, or leave it out for all")
    batteries = fields.integer("batteries", 1, minimum=1)
    turnaround_s = fields.number("turnaround_s", 0.0, minimum=0.0)
    if batteries == 1:
        fields.unused("turnaround_s", "is the time between flights, and it has one battery")
    max_items = _fewer_items(fields, autopilot, kind)
    aloft = _aloft(fields, owner, kind, findings)
    finish: Any = fields.choice("finish", ("auto", "land", "return", "loiter"), "auto")
    if "reserve" in fields and energy_wh is None:
        fields.wrong("reserve", "is a part of energy_wh, which is missing", "Add energy_wh or remove it.")
    if energy_wh is not None and power is None and not {"power", "cruise_power_w"} & set(raw):
        fields.wrong(
            "energy_wh",
            "has no power model",
            "Add power, or cruise_power_w for a constant one; or leave energy_wh out.",
            rule="no-power-model",
        )
    if aloft is not None and batteries not in (None, 1):
        fields.wrong(
            "batteries",
            f"is {batteries}, but it flies already: what is left is one flight",
            "Set batteries to 1, and plan further flights when it has landed.",
        )
    fields.refuse_unknown()
    if name is None or airspeed_m_s is None or radius_m is None or max_climb_deg is None or settle_m is None:
        return None
    if kind is None or autopilot is None or reserve is None or finish is None:
        return None
    if autopilot == "px4" and kind != "multirotor" and finish not in ("auto", "land"):
        fields.wrong(
            "finish",
            f"is {finish}, but PX4's wings take no mission without a landing (MIS_TKO_LAND_REQ)",
            "Set finish to land, or leave it out.",
            rule="finish-not-flown",
        )
        return None
    return Aircraft(
        name, kind, autopilot, airspeed_m_s, radius_m, max_climb_deg, energy_wh, power, range_m, time_s,
        settle_m, base, reserve=reserve, finish=finish,
        min_airspeed_m_s=slowest_m_s, sensors=sensors, batteries=batteries, turnaround_s=turnaround_s or 0.0,
        aloft=aloft, max_items=max_items, end_bases=end_bases, voltage_v=voltage_v,
    )  # fmt: skip


def _fewer_items(fields: Fields, autopilot: Any, kind: Any) -> int | None:
    """How many items of a mission are to be had at most, where that is said."""
    asked = fields.integer("max_items", 0, minimum=LEAST_ITEMS)
    usual = MOST_ITEMS.get((autopilot, kind == "multirotor"), 0)
    if usual and asked > usual:
        fields.wrong(
            "max_items",
            f"is {asked}, and {autopilot} is uploaded {usual} at most",
            f"Give {usual} or fewer, or leave it out.",
            rule="out-of-range",
        )
        return None
    return asked or None


def _aloft(fields: Fields, owner: str, kind: str | None, findings: Findings) -> Aloft | None:
    """Where an aircraft is that flies already."""
    raw = fields.raw("in_flight")
    if raw is None:
        return None
    if not isinstance(raw, dict):
        fields.wrong("in_flight", f"is {raw!r}", "Give lon_deg, lat_deg, height_m over home and heading_deg.")
        return None
    place = Fields(f"in_flight of {owner}", raw, findings)
    lon_deg = place.number("lon_deg", minimum=-180.0, maximum=180.0)
    lat_deg = place.number("lat_deg", minimum=-90.0, maximum=90.0)
    height_m = place.number("height_m", above=0.0, maximum=HIGHEST_ALOFT_M)
    heading_deg = place.number("heading_deg", None, minimum=0.0, maximum=360.0)
    place.refuse_unknown()
    if heading_deg is None and kind != "multirotor":
        place.wrong(
            "heading_deg",
            "is missing: what flies on wings goes on where it is heading",
            "Add heading_deg, clockwise from true north.",
            "missing-property",
        )
        return None
    if lon_deg is None or lat_deg is None or height_m is None:
        return None
    return Aloft(lon_deg, lat_deg, height_m, heading_deg)


def _of_model(raw: dict[str, Any], fields: Fields) -> dict[str, Any]:
    """An entry with what it leaves to the airframe that it names."""
    model = fields.text("model", None)
    if model is None:
        return raw
    try:
        return completed(raw, find_airframe(model))
    except KeyError as error:
        fields.wrong("model", f"is unknown: {error.args[0]}", "Name one of them, or leave model out.")
        return raw


def _stored_wh(fields: Fields) -> tuple[float | None, float | None]:
    """Energy of the battery: as given, or charge by voltage; and that voltage."""
    energy_wh = fields.number("energy_wh", None, above=0.0)
    charge_mah = fields.number("charge_mah", None, above=0.0)
    voltage_v = fields.number("voltage_v", None, above=0.0)
    given = [name for name in ("charge_mah", "voltage_v") if name in fields]
    if given and "energy_wh" in fields:
        fields.wrong(given[0], "is given beside energy_wh, which says it too", "Keep one of them.")
        return energy_wh, None
    if len(given) == 1:
        other = "voltage_v" if given == ["charge_mah"] else "charge_mah"
        fields.wrong(other, f"is missing beside {given[0]}", f"Add {other}.", rule="missing-property")
    if charge_mah is not None and voltage_v is not None:
        return charge_mah * voltage_v / 1000.0, voltage_v
    return energy_wh, None


def _names(fields: Fields, name: str, of: str) -> tuple[str, ...] | None:
    value = fields.raw(name)
    if value is None:
        return None
    if not isinstance(value, list) or not value or not all(isinstance(v, str) and v for v in value):
        fields.wrong(name, f"is {value!r}", f"Give a list of names of {of}.")
        return None
    return tuple(dict.fromkeys(value))


def shared_steadiness(vehicles: Iterable[Any]) -> Steadiness | None:
    """The least steady of all that is known of the carriers; None where nothing is."""
    known = [steady for raw in vehicles if (steady := named_steadiness(raw)) is not None]
    if not known:
        return None
    return Steadiness(
        max(steady.settle_s for steady in known),
        max(steady.pointing_deg for steady in known),
        max(steady.position_m for steady in known),
        max(steady.kept_m for steady in known),
    )


def named_steadiness(raw: Any) -> Steadiness | None:
    """Of the autopilot that an entry of ``vehicles`` names; None where it names none that is known."""
    if not isinstance(raw, Mapping):
        return None
    model = raw.get("model")
    if isinstance(model, str) and is_airframe(model):
        raw = completed(raw, find_airframe(model))
    autopilot: Any = raw.get("autopilot")
    kind: Any = raw.get("type") or "fixed_wing"
    if autopilot not in AUTOPILOTS or kind not in VEHICLE_TYPES:
        return None
    return steadiness_of(autopilot, kind)


def kept_m(aircraft: Iterable[Aircraft | None]) -> float:
    """Kept from everything hard where a scenario does not say: what each of its autopilots needs."""
    return max((steadiness_of(a.autopilot, a.type).kept_m for a in aircraft if a is not None), default=0.0)


def _turn_radius_m(fields: Fields, airspeed_m_s: float | None, kind: str | None) -> float | None:
    """The widest of the turn radii that the given limits demand."""
    radius_m = fields.number("min_turn_radius_m", None, minimum=LEAST_RADIUS_M)
    bank_deg = fields.number("max_bank_deg", None, above=0.0, below=85.0)
    load_factor = fields.number("max_load_factor", None, above=1.0)
    if airspeed_m_s is None:
        return None
    radii = [] if radius_m is None else [radius_m]
    if bank_deg is not None:
        radii.append(turn_radius_from_bank_m(airspeed_m_s, bank_deg))
    if load_factor is not None:
        radii.append(turn_radius_from_load_factor_m(airspeed_m_s, load_factor))
    if radius_m is None and kind == "multirotor":
        # How it banks and at which load holds at speed; for its corners it slows down.
        return CORNER_RADIUS_M
    if not radii:
        if not {"min_turn_radius_m", "max_bank_deg", "max_load_factor"} & set(_given(fields)):
            fields.wrong(
                "min_turn_radius_m",
                "is missing",
                "Add min_turn_radius_m, max_bank_deg or max_load_factor.",
                rule="missing-property",
            )
        return None
    return max(radii)


def _given(fields: Fields) -> list[str]:
    return [n for n in ("min_turn_radius_m", "max_bank_deg", "max_load_factor") if n in fields]


def read_sensor(raw: Any, index: int, findings: Findings, steady: Steadiness | None = None) -> Sensor | None:
    """One entry of ``sensors``, with the margins that its carrier needs where it states none."""
    if not isinstance(raw, dict):
        findings.error("scenario", "bad-value", f"sensors[{index}] is not an object", "Give an object.")
        return None
    name = raw.get("name")
    margins = {}
    if steady is not None:
        margins = {"pointing_margin_deg": steady.pointing_deg, "position_margin_m": steady.position_m}
    fields = Fields(f"sensor {name if name else index}", raw, findings, margins)
    kind = fields.choice("type", KINDS)
    if kind is None:
        fields.text("name")
        return None
    sensor = KINDS[kind].read(fields)
    fields.refuse_unknown()
    return sensor


_WRITTEN = {
    "wind": '{"speed_m_s": 8, "from_deg": 270}',
    "objective": '{"missile": 2000}',
    "method": '{"routing": "auto"}',
    "search": '{"detection": 0.8}',
    "drift": '{"speed_m_s": 0.5, "toward_deg": 90}',
}


def as_object(name: str, raw: Any, findings: Findings) -> dict[str, Any]:
    """A member that has to be an object; another value is found, never ignored."""
    if isinstance(raw, dict):
        return raw
    findings.error("scenario", "bad-value", f"{name} is not an object", f"Write {name}: {_WRITTEN[name]}.")
    return {}


def read_wind(raw: Any, frame: LocalFrame, findings: Findings) -> Wind:
    """Member ``wind``."""
    if raw is None:
        return Wind()
    fields = Fields("wind", as_object("wind", raw, findings), findings)
    speed_m_s = fields.number("speed_m_s", minimum=0.0, maximum=100.0) or 0.0
    from_deg = fields.number(
        "from_deg", 0.0 if not speed_m_s else fields.raw("from_deg"), minimum=0.0, maximum=360.0
    )
    fields.refuse_unknown()
    return Wind(speed_m_s, frame.direction_rad((from_deg or 0.0) + 180.0))


def read_objective(raw: Any, findings: Findings) -> Objective:
    """Member ``objective``."""
    if raw is None:
        return Objective()
    fields = Fields("objective", as_object("objective", raw, findings), findings)
    defaults = Objective()
    weights = {
        name: fields.number(name, getattr(defaults, name), minimum=0.0) for name in Objective.__slots__
    }
    fields.refuse_unknown()
    return Objective(**{name: getattr(defaults, name) if w is None else w for name, w in weights.items()})


def read_method(raw: Any, findings: Findings) -> Method:
    """Member ``method``."""
    if raw is None:
        return Method()
    fields = Fields("method", as_object("method", raw, findings), findings)
    chosen = {stage: fields.choice(stage, names, "auto") or "auto" for stage, names in METHODS.items()}
    directions = fields.integer("directions", Method().directions, minimum=2)
    if directions > MOST_DIRECTIONS:
        fields.wrong(
            "directions", f"is {directions}, must be ≤ {MOST_DIRECTIONS}", "Give fewer.", rule="out-of-range"
        )
    fields.refuse_unknown()
    if chosen["coverage"] in OWN_ORDER and chosen["routing"] != "auto":
        findings.error(
            "method",
            "bad-value",
            f"coverage {chosen['coverage']} has an order of its own, routing {chosen['routing']} another",
            "Leave routing out.",
        )
    return Method(**chosen, directions=directions)


def listed(document: Mapping[str, Any], name: str, findings: Findings) -> list[Any]:
    """A member that must be a non-empty list."""
    value = document.get(name)
    if not isinstance(value, list) or not value:
        findings.error("scenario", "missing-member", f"{name} is missing or empty", f"Add {name}: a list.")
        return []
    return value
