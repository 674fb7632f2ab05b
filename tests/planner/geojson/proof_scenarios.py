"""Small scenarios and what can be added to them, for the proofs that every property changes something."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np

from tests.planner.scenarios import feature, of_two, small, square

Document = dict[str, Any]


def with_features(*more: Document, **members: Any) -> Document:
    """The small scenario and more."""
    return small(*more, **members)


def of_feature(name: str, *more: Document, **properties: Any) -> Document:
    """The small scenario with properties of one feature added."""
    document = small(*more)
    (found,) = [each for each in document["features"] if each["id"] == name]
    found["properties"] |= properties
    return document


def of_member(member: str, document: Document | None = None, **properties: Any) -> Document:
    """The small scenario with properties of the vehicle or of the sensor added; None takes one away."""
    document = copy.deepcopy(document or small())
    merged = {**document[member][0], **properties}
    document[member] = [{k: v for k, v in merged.items() if v is not None}]
    return document


def vehicle(document: Document | None = None, **properties: Any) -> Document:
    return of_member("vehicles", document, **properties)


def aloft(**place: Any) -> Document:
    """Its aircraft in the air over its start."""
    document = small()
    (start,) = (f for f in document["features"] if f["properties"]["role"] == "start")
    lon_deg, lat_deg = start["geometry"]["coordinates"][:2]
    here = {"lon_deg": lon_deg, "lat_deg": lat_deg, "height_m": 300.0, "heading_deg": 90.0}
    return vehicle(document, in_flight=here | place)


def sensor(document: Document | None = None, **properties: Any) -> Document:
    return of_member("sensors", document, **properties)


def with_name(kind: str) -> Document:
    """The small scenario with a feature of a role whose name is told: of the area where it is wrong."""
    document = with_features(*EXTRA.get(kind, ()))
    if kind == "area":
        document["features"][2]["geometry"]["coordinates"] = square(0.001, 0.001, 0.001)
        document["features"][2]["geometry"]["coordinates"][0][1:3] = [[0.002, 0.002], [0.002, 0.001]]
    return document


def renamed(kind: str) -> Document:
    """The small scenario with one feature of a role named otherwise, by its properties."""
    document = with_name(kind)
    for each in document["features"]:
        if each["properties"]["role"] == kind:
            each["properties"]["name"] = "other"
            del each["id"]
            break
    return document


def doubted(kind: str) -> Document:
    """The small scenario with one feature whose role is in doubt."""
    document = with_name(kind)
    (found, *_) = [each for each in document["features"] if each["properties"]["role"] == kind]
    found["properties"]["role_in_doubt"] = "its file says so"
    return document


def threat(**properties: Any) -> Document:
    return feature(
        "T", "threat", "Point", [0.012, 0.004], **{"model": "missile", "radius_m": 400.0, **properties}
    )


def radar(intensity_m: float) -> Document:
    """A radar over a region."""
    return feature(
        "T", "threat", "Point", [0.0015, 0.0015], model="radar", radius_m=900.0, intensity_m=intensity_m
    )


def disc(**properties: Any) -> Document:
    return feature("N", "no_fly", "Point", [0.012, 0.004], **{"radius_m": 300.0, **properties})


def block(**properties: Any) -> Document:
    return feature("O", "obstacle", "Polygon", square(0.012, 0.0, 0.004), **{"height_m": 520.0, **properties})


def line(**properties: Any) -> Document:
    return feature("L", "roi", "LineString", [[0.01, 0.03], [0.03, 0.04]], **{"width_m": 50.0, **properties})


def target(**properties: Any) -> Document:
    return feature("P", "roi", "Point", [0.01, 0.03], **properties)


def end(**properties: Any) -> Document:
    return feature("end", "end", "Point", [0.05, 0.03], **properties)


def value(**properties: Any) -> Document:
    return feature("I", "importance", "Polygon", square(0.0, 0.0, 0.01), **{"score": 1.0, **properties})


def flying_on(*passes: Any) -> Document:
    """A search planned anew, with passes that it was still to fly."""
    told = {"unflown": {"uav": list(passes)}} if passes else {}
    return {**last_known(), "replan": told}


def last_known(spread_m: float = 400.0, **search: Any) -> Document:
    """A search round a last known point, within an hour's flight."""
    point = feature("K", "importance", "Point", [0.01, 0.01], score=1.0, spread_m=spread_m)
    document = vehicle(with_features(point), max_flight_time_s=1500.0)
    document |= {"task": "search", "method": {"search": "parallel"}}
    return {**document, "search": search} if search else document


def drifting(**drift: Any) -> Document:
    """The same for what drifts."""
    return last_known(drift={"speed_m_s": 0.5, "toward_deg": 90.0, **drift})


def looked_at(**told: Any) -> Document:
    """The same, after a look to the east over the south of where it may be."""
    geometry = {"type": "Polygon", "coordinates": square(0.0, 0.0, 0.01)}
    seen = [{"type": "Feature", "geometry": geometry, "properties": {"ago_s": [300.0, 240.0], **told}}]
    return last_known(drift={"speed_m_s": 2.0, "toward_deg": 90.0}, seen=seen)


def based(place: float = -0.03, base: str | None = "B1", **properties: Any) -> Document:
    """Two bases, of which the vehicle names one."""
    bases = [
        feature(f"B{k}", "base", "Point", [place - 0.01 * k, -0.03], **(properties if k == 1 else {}))
        for k in (0, 1)
    ]
    return vehicle(with_features(*bases), base=base)


def two_aircraft(**properties: Any) -> Document:
    """Two aircraft, of which one has more properties."""
    document = of_two()
    one, other = document["vehicles"]
    return document | {"vehicles": [one, other | properties]}


def two_aircraft_optional() -> Document:
    """Two aircraft, and a region that need not be seen."""
    document = two_aircraft()
    document["features"][0]["properties"]["required"] = False
    return document


def two_sensors(name: str) -> Document:
    """Two sensors that look to different sides."""
    document = of_feature("A", sensor=name)
    document["sensors"].append({**document["sensors"][0], "name": "other", "look": "left"})
    return document


def short_of(priority: float) -> Document:
    """Two optional regions of which one is in range."""
    far = [
        feature(n, "roi", "Polygon", square(e, 0.04, 0.002), required=False, priority=p)
        for n, e, p in (("X", -0.03, priority), ("Y", 0.05, 1.0))
    ]
    return vehicle(with_features(*far), max_range_m=26_000.0)


def many(budget_s: float) -> Document:
    """More regions than the exact order takes, and a time to plan them in."""
    rng = np.random.default_rng(3)
    places = rng.uniform(-0.04, 0.06, (14, 2)).tolist()
    regions = [feature(f"M{k}", "roi", "Polygon", square(e, n, 0.002)) for k, (e, n) in enumerate(places)]
    return small(*regions, time_budget_s=budget_s)


def spot(**properties: Any) -> Document:
    """A target seen in spotlight."""
    document = sensor(with_features(target()), **{"mode": "spotlight", "resolution_m": 0.5, **properties})
    document["features"] = [each for each in document["features"] if each["id"] not in ("A", "B")]
    return document


def camera(document: Document | None = None, **properties: Any) -> Document:
    """The small scenario seen by a camera; None takes a property of it away."""
    sensor = {"name": "eye", "type": "camera", "model": "Sony a6000 20 mm", "rer": 0.85, "snr": 40.0}
    listed = {k: v for k, v in {**sensor, **properties}.items() if v is not None}
    return copy.deepcopy(document or small(altitude_m=300.0)) | {"sensors": [listed]}


def by_figures(**properties: Any) -> Document:
    """The same by lens and chip."""
    figures = {"focal_length_m": 0.02, "pixel_pitch_m": 4e-6, "image_px": [6000, 4000]}
    return camera(**{"model": None, **figures, **properties})


def member(name: str, given: Any) -> Document:
    return small(**{name: given})


#: Of each power model a value for each of its properties that is not the one it has in ``powered``.
POWERS: dict[str, dict[str, Any]] = {
    "constant": {"model": "rotary", "power_w": 250.0},
    "drag_polar": {
        "mass_kg": 4.0, "wing_area_m2": 0.7, "aspect_ratio": 9.0, "cd0": 0.05, "oswald": 0.9,
        "efficiency": 0.5, "avionics_w": 12.0, "hover_w": 700.0,
    },
    "multirotor": {
        "disc_area_m2": 0.3, "figure_of_merit": 0.7, "drag_area_m2": 0.02,
    },
    "rotors": {"rotors": 6, "rotor_diameter_m": 0.3},
    "table": {"table": [[0.0, 300.0], [20.0, 500.0]]},
}  # fmt: skip
OF_POWER: dict[str, dict[str, Any]] = {
    "constant": {"model": "constant", "power_w": 200.0},
    "drag_polar": {
        "model": "drag_polar", "mass_kg": 3.0, "wing_area_m2": 0.5, "aspect_ratio": 8.0, "cd0": 0.03,
        "hover_w": 600.0,
    },
    "multirotor": {"model": "multirotor", "mass_kg": 2.0, "disc_area_m2": 0.2},
    "rotors": {"model": "multirotor", "mass_kg": 2.0, "rotors": 4, "rotor_diameter_m": 0.25},
    "table": {"model": "multirotor", "table": [[0.0, 300.0], [20.0, 400.0]]},
}  # fmt: skip


def powered(case: str, **properties: Any) -> Document:
    """The small scenario flown by what one of the power models is for."""
    kind = {"constant": "fixed_wing", "drag_polar": "vtol"}.get(case, "multirotor")
    return vehicle(type=kind, power={**OF_POWER[case], **properties})


CROSSED = feature("T", "threat", "Point", [0.016, 0.006], model="missile", radius_m=900.0)
#: In the way of one leg, small: its programme has few steps.
NEAR = feature("T", "threat", "Point", [0.016, 0.006], model="missile", radius_m=300.0)
WIND = {"speed_m_s": 8.0, "from_deg": 200.0}
EXTRA = {
    "threat": (threat(hard=True),), "no_fly": (disc(),), "obstacle": (block(),), "end": (end(),),
    "importance": (value(),), "base": (feature("H", "base", "Point", [0.03, 0.03]),),
}  # fmt: skip
ROUTED = {"routing": "li2018"}
SSAS = {"routing": "li2018", "transit": "ssas"}
