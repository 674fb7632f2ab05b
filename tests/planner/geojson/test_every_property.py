"""No property is accepted that nothing reads: each changes the plan, the mission, a finding or a refusal."""

from __future__ import annotations

import contextlib
import copy
import itertools
import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from mavlink.encoding.encode import encode
from planner.airspace.terrain import Terrain
from planner.errors import InfeasibleError, ScenarioError
from planner.geojson import read_scenario, write_plan
from planner.geojson.fields import Fields
from planner.pipeline import make_plan
from planner.validate import findings
from tests.planner.scenarios import case, feature, small, square
from tests.planner.terrains import raster

Document = dict[str, Any]

#: The members of a plan that only repeat what was asked.
ECHOES = ("scenario_hash", "methods", "vehicles", "altitude_m", "altitude_reference")


def hill() -> dict[str, Terrain]:
    """A raster with a hill between the regions."""
    frame = read_scenario(small()).frame
    return {"hill": raster(lambda e, n: 900.0 * np.exp(-((e - 1500.0) ** 2 + (n - 500.0) ** 2) / 5e5), frame)}


def outcome(document: Document) -> str:
    """Everything a client gets of a scenario, echoes and times left out."""
    terrains = hill() if "terrain" in document else None
    said = [str(finding) for finding in findings(document, terrains)]
    try:
        ticks = itertools.count()
        clock = (lambda: float(next(ticks))) if "time_budget_s" in document else None
        plan = make_plan(read_scenario(document, terrains), clock=clock)
    except (ScenarioError, InfeasibleError) as error:
        return json.dumps([*said, str(error)])
    written = write_plan(plan)
    written["metrics"] = {k: v for k, v in written["metrics"].items() if k != "planning_time_s"}
    mission = encode(plan, vehicle=plan.vehicles[0].name, autopilot=None)
    rest = {name: value for name, value in written.items() if name not in ECHOES}
    return json.dumps([said, rest, repr(mission)], default=str)


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


def based(place: float = -0.03, base: str | None = "B1", **properties: Any) -> Document:
    """Two bases, of which the vehicle names one."""
    bases = [
        feature(f"B{k}", "base", "Point", [place - 0.01 * k, -0.03], **(properties if k == 1 else {}))
        for k in (0, 1)
    ]
    return vehicle(with_features(*bases), base=base)


def two_aircraft(**properties: Any) -> Document:
    """Two aircraft, of which one has more properties."""
    document = small()
    (one,) = document["vehicles"]
    return document | {"vehicles": [one, one | {"name": "other"} | properties]}


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
    regions = [feature(f"M{k}", "roi", "Polygon", square(*place, 0.002)) for k, place in enumerate(places)]
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
WIND = {"speed_m_s": 8.0, "from_deg": 200.0}
EXTRA = {
    "threat": (threat(hard=True),), "no_fly": (disc(),), "obstacle": (block(),), "end": (end(),),
    "importance": (value(),), "base": (feature("H", "base", "Point", [0.03, 0.03]),),
}  # fmt: skip
ROUTED = {"routing": "li2018"}
SSAS = {"routing": "li2018", "transit": "ssas"}

#: Of each kind and property two scenarios that differ in it, and so must what comes of them.
PROOFS: dict[tuple[str, str], tuple[Document, Document]] = {
    ("roi", "priority"): (short_of(0.2), short_of(5.0)),
    ("roi", "required"): (
        of_feature("A", disc(radius_m=900.0), min_resolution_m=1.0),
        of_feature("A", disc(radius_m=900.0), min_resolution_m=1.0, required=False),
    ),
    ("roi", "sensor"): (two_sensors("sar"), two_sensors("other")),
    ("roi", "min_resolution_m"): (small(), of_feature("A", min_resolution_m=1.0)),
    ("roi", "approach_deg"): (small(), of_feature("A", approach_deg=[80.0])),
    ("roi", "revisits"): (small(), of_feature("A", revisits=2)),
    ("roi", "altitude_m"): (small(), of_feature("A", altitude_m=320.0)),
    ("roi", "width_m"): (with_features(line()), with_features(line(width_m=250.0))),
    ("roi", "radius_m"): (with_features(target()), with_features(target(radius_m=150.0))),
    ("roi", "time_window_s"): (small(), of_feature("A", time_window_s=[0, 600])),
    ("roi", "revisit_after_s"): (
        of_feature("A", revisits=2), of_feature("A", revisits=2, revisit_after_s=600.0),
    ),
    ("roi", "min_niirs"): (small(), of_feature("A", min_niirs=5.4)),
    ("roi", "pattern"): (camera(), camera(of_feature("A", pattern="crosshatch"))),
    ("roi", "gsd_m"): (camera(), camera(of_feature("A", gsd_m=0.03))),
    ("threat", "model"): (
        with_features(threat(model="radar", intensity_m=300.0)), with_features(threat(intensity_m=300.0)),
    ),
    ("threat", "radius_m"): (with_features(threat()), with_features(threat(radius_m=600.0))),
    ("threat", "intensity_m"): (
        with_features(radar(3.0)),
        with_features(radar(300.0)),
    ),
    ("threat", "height_m"): (with_features(threat()), with_features(threat(height_m=300.0))),
    ("threat", "hard"): (with_features(threat()), with_features(threat(hard=True))),
    ("no_fly", "radius_m"): (with_features(disc()), with_features(disc(radius_m=500.0))),
    ("no_fly", "floor_m"): (with_features(disc()), with_features(disc(floor_m=9000.0))),
    ("no_fly", "ceiling_m"): (with_features(disc()), with_features(disc(ceiling_m=-500.0))),
    ("obstacle", "height_m"): (with_features(block()), with_features(block(height_m=100.0))),
    ("obstacle", "base_m"): (
        with_features(block(height_m=100.0)), with_features(block(height_m=100.0, base_m=420.0)),
    ),
    ("start", "heading_deg"): (small(), of_feature("start", heading_deg=200.0)),
    ("end", "heading_deg"): (with_features(end()), with_features(end(heading_deg=200.0))),
    ("base", "heading_deg"): (based(), based(heading_deg=200.0)),
    ("importance", "score"): (with_features(value()), with_features(value(score=2.0))),
    ("vehicle", "name"): (small(), vehicle(name="other")),
    ("vehicle", "type"): (small(), vehicle(type="vtol")),
    ("vehicle", "autopilot"): (small(), vehicle(autopilot="px4")),
    ("vehicle", "airspeed_m_s"): (small(), vehicle(airspeed_m_s=25.0)),
    ("vehicle", "min_turn_radius_m"): (small(), vehicle(min_turn_radius_m=150.0)),
    ("vehicle", "max_bank_deg"): (small(), vehicle(max_bank_deg=10.0)),
    ("vehicle", "max_load_factor"): (small(), vehicle(max_load_factor=1.02)),
    ("vehicle", "max_climb_deg"): (vehicle(max_climb_deg=8.0), vehicle(max_climb_deg=3.0)),
    ("vehicle", "energy_wh"): (vehicle(cruise_power_w=200.0), vehicle(cruise_power_w=200.0, energy_wh=5.0)),
    ("vehicle", "reserve"): (
        vehicle(cruise_power_w=200.0, energy_wh=50.0),
        vehicle(cruise_power_w=200.0, energy_wh=50.0, reserve=0.9),
    ),
    ("vehicle", "cruise_power_w"): (small(), vehicle(cruise_power_w=200.0)),
    ("vehicle", "power"): (small(), vehicle(power={"model": "constant", "power_w": 200.0})),
    **{
        ("power", name): (powered(model), powered(model, **{name: value}))
        for model, changes in POWERS.items()
        for name, value in changes.items()
    },
    ("vehicle", "max_range_m"): (small(), vehicle(max_range_m=1000.0)),
    ("vehicle", "max_flight_time_s"): (small(), vehicle(max_flight_time_s=100.0)),
    ("vehicle", "min_airspeed_m_s"): (
        camera(forward_overlap=0.95),
        camera(vehicle(small(altitude_m=300.0), min_airspeed_m_s=8.0), forward_overlap=0.95),
    ),
    ("vehicle", "settle_m"): (small(), vehicle(settle_m=300.0)),
    ("vehicle", "finish"): (small(), vehicle(finish="land")),
    ("vehicle", "base"): (based(), based(base="B0")),
    ("vehicle", "sensors"): (two_aircraft(), two_aircraft(sensors=["eye"])),
    ("vehicle", "batteries"): (vehicle(max_range_m=1000.0), vehicle(max_range_m=1000.0, batteries=4)),
    ("vehicle", "turnaround_s"): (vehicle(batteries=1), vehicle(batteries=1, turnaround_s=60.0)),
    ("separation", "horizontal_m"): (small(), member("separation", {"horizontal_m": -50.0})),
    ("separation", "vertical_m"): (small(), member("separation", {"vertical_m": -50.0})),
    ("sensor", "name"): (small(), sensor(name="other")),
    ("sensor", "type"): (small(), sensor(type="camera")),
    ("sensor", "incidence_deg"): (small(), sensor(incidence_deg=40.0)),
    ("sensor", "elevation_beamwidth_deg"): (small(), sensor(elevation_beamwidth_deg=20.0)),
    ("sensor", "azimuth_beamwidth_deg"): (small(), sensor(azimuth_beamwidth_deg=5.0)),
    ("sensor", "aperture_length_m"): (
        sensor(azimuth_beamwidth_deg=None, aperture_length_m=0.3, wavelength_m=0.03),
        sensor(azimuth_beamwidth_deg=None, aperture_length_m=0.6, wavelength_m=0.03),
    ),
    ("sensor", "wavelength_m"): (spot(wavelength_m=0.03), spot(wavelength_m=0.06)),
    ("sensor", "frequency_hz"): (spot(frequency_hz=1e10), spot(frequency_hz=5e9)),
    ("sensor", "resolution_m"): (small(), sensor(resolution_m=1.0)),
    ("sensor", "look"): (small(), sensor(look="left")),
    ("sensor", "squint_deg"): (small(), sensor(squint_deg=10.0)),
    ("sensor", "mode"): (
        sensor(elevation_beamwidth_deg=10.0, resolution_m=1.0),
        sensor(elevation_beamwidth_deg=10.0, resolution_m=1.0, mode="scansar"),
    ),
    ("sensor", "sub_swaths"): (
        sensor(mode="scansar", elevation_beamwidth_deg=10.0, sub_swaths=2),
        sensor(mode="scansar", elevation_beamwidth_deg=10.0, sub_swaths=3),
    ),
    ("sensor", "pointing_margin_deg"): (small(), sensor(pointing_margin_deg=3.0)),
    ("sensor", "position_margin_m"): (small(), sensor(position_margin_m=20.0)),
    ("sensor", "stabilised"): (small(wind=WIND), sensor(small(wind=WIND), stabilised=True)),
    ("sensor", "model"): (camera(), camera(model="DJI Zenmuse P1 24 mm")),
    ("sensor", "focal_length_m"): (by_figures(), by_figures(focal_length_m=0.03)),
    ("sensor", "pixel_pitch_m"): (by_figures(), by_figures(pixel_pitch_m=3e-6)),
    ("sensor", "image_px"): (by_figures(), by_figures(image_px=[5000, 4000])),
    ("sensor", "forward_overlap"): (camera(), camera(forward_overlap=0.8)),
    ("sensor", "side_overlap"): (camera(), camera(side_overlap=0.8)),
    ("sensor", "tilt_deg"): (camera(), camera(tilt_deg=20.0)),
    ("sensor", "min_interval_s"): (camera(), camera(min_interval_s=30.0)),
    ("sensor", "trigger"): (camera(), camera(trigger="time")),
    ("sensor", "spectrum"): (camera(), camera(spectrum="infrared")),
    ("sensor", "rer"): (camera(), camera(rer=0.95)),
    ("sensor", "snr"): (camera(), camera(snr=10.0)),
    ("sensor", "noise_gain"): (camera(), camera(noise_gain=5.4)),
    ("sensor", "photo_mb"): (camera(), camera(photo_mb=25.0)),
    ("sensor", "overshoot"): (camera(), camera(overshoot=0.2)),
    ("wind", "speed_m_s"): (member("wind", WIND), member("wind", WIND | {"speed_m_s": 4.0})),
    ("wind", "from_deg"): (member("wind", WIND), member("wind", WIND | {"from_deg": 20.0})),
    ("objective", "length"): (small(CROSSED), small(CROSSED, objective={"length": 2000.0})),
    ("objective", "missile"): (small(CROSSED), small(CROSSED, objective={"missile": 0.01})),
    ("objective", "radar"): (
        small(threat(model="radar", intensity_m=3.0, radius_m=700.0)),
        small(threat(model="radar", intensity_m=3.0, radius_m=700.0), objective={"radar": 0.0}),
    ),
    ("objective", "energy"): (small(CROSSED), small(CROSSED, objective={"energy": 2000.0})),
    ("objective", "turns"): (case(2), case(2) | {"objective": {"turns": 30.0}}),
    ("method", "coverage"): (
        of_feature("A", revisits=2),
        of_feature("A", revisits=2) | {"method": {"coverage": "li2018"}},
    ),
    ("method", "routing"): (case(1), case(1) | {"method": ROUTED}),
    ("method", "transit"): (small(CROSSED, method=ROUTED), small(CROSSED, method=SSAS)),
    ("method", "smoothing"): (
        small(CROSSED, method=SSAS), small(CROSSED, method=SSAS | {"smoothing": "shortcut"}),
    ),
    ("method", "search"): (small(), member("method", {"search": "belief"})),
    ("scenario", "name"): (small(), member("name", "other")),
    ("scenario", "bbox"): (small(), member("bbox", [0.0, 0.0, 0.01, 0.01])),
    ("scenario", "crs"): (small(), member("crs", "EPSG:3857")),
    ("scenario", "altitude_m"): (small(), member("altitude_m", 600.0)),
    ("scenario", "min_height_m"): (
        camera(of_feature("A", gsd_m=0.01)), camera(of_feature("A", gsd_m=0.01) | {"min_height_m": 200.0}),
    ),
    ("scenario", "max_height_m"): (
        camera(of_feature("A", gsd_m=0.1)), camera(of_feature("A", gsd_m=0.1) | {"max_height_m": 480.0}),
    ),
    ("scenario", "altitude_reference"): (
        with_features(disc(floor_m=400.0)), with_features(disc(floor_m=400.0), altitude_reference="amsl"),
    ),
    ("scenario", "terrain"): (small(), member("terrain", "hill")),
    ("scenario", "terrain_following"): (
        member("terrain", "hill"), small(terrain="hill", terrain_following=True),
    ),
    ("scenario", "clearance_m"): (with_features(block()), with_features(block(), clearance_m=60.0)),
    ("scenario", "task"): (small(), member("task", "search")),
    ("scenario", "seed"): (small(), member("seed", 5)),
    ("scenario", "time_budget_s"): (many(1e9), many(1e-3)),
}  # fmt: skip
ROLES = ("roi", "threat", "no_fly", "obstacle", "end", "importance", "base", "start", "area")
PROOFS |= {(role, "name"): (with_name(role), renamed(role)) for role in ROLES}
PROOFS |= {(role, "role_in_doubt"): (with_name(role), doubted(role)) for role in ROLES}

#: Members that hold the others, and what says which reader reads a feature.
STRUCTURE = {
    ("scenario", name)
    for name in ("type", "features", "vehicles", "sensors", "wind", "objective", "method", "separation")
}


def accepted(monkeypatch: pytest.MonkeyPatch) -> set[tuple[str, str]]:
    """Every kind and property that the reader knows, as it says itself while it reads all proofs."""
    found: set[tuple[str, str]] = set()
    terrains = hill()
    roles: dict[str, str] = {}
    plain: Callable[..., None] = Fields.refuse_unknown

    def noted(self: Fields, *, also_known: Any = ()) -> None:
        kind = self.owner.split(" ")[0] if self.owner not in roles else roles[self.owner]
        found.update((kind, name) for name in self._known | set(also_known))
        plain(self, also_known=also_known)

    monkeypatch.setattr(Fields, "refuse_unknown", noted)
    for document in itertools.chain.from_iterable(PROOFS.values()):
        roles = {
            each.get("id", each["properties"].get("name")): each["properties"]["role"]
            for each in document["features"]
        }
        with contextlib.suppress(ScenarioError):
            read_scenario(document, terrains if "terrain" in document else None)
    return {(kind, name) for kind, name in found if name != "role"}


def test_each_accepted_property_has_a_proof(monkeypatch: pytest.MonkeyPatch) -> None:
    """What the reader knows and the proofs below are the same properties."""
    assert accepted(monkeypatch) == set(PROOFS) | STRUCTURE


@pytest.mark.parametrize(("kind", "name"), sorted(PROOFS))
def test_each_accepted_property_changes_something(kind: str, name: str) -> None:
    """Scenarios that differ in it alone differ in plan, mission, findings or refusal."""
    before, after = PROOFS[kind, name]
    assert before != after
    assert outcome(before) != outcome(after)


@pytest.mark.parametrize(
    ("document", "name"),
    [
        (member("description", "a flight"), "description"),
        (of_feature("A", radius_m=5.0), "radius_m"),
        (of_feature("area", hard=True), "hard"),
        (vehicle(battery=2), "battery"),
        (sensor(gain=2.0), "gain"),
        (member("spacing", {"vertical_m": 30.0}), "spacing"),
    ],
)
def test_what_nothing_reads_is_refused_by_name(document: Document, name: str) -> None:
    """Properties without a reader are unknown, and named."""
    with pytest.raises(ScenarioError) as refused:
        read_scenario(document)
    assert [f.rule for f in refused.value.findings] == ["unknown-property"]
    assert repr(name) in refused.value.findings[0].message


@pytest.mark.parametrize(
    ("document", "rule"),
    [
        (sensor(wavelength_m=0.03), "not-used"),
        (sensor(frequency_hz=1e10), "not-used"),
        (with_features(threat(intensity_m=100.0)), "not-used"),
        (with_features(*EXTRA["base"]), "not-used"),
        (sensor(aperture_length_m=3.0, wavelength_m=0.03), "bad-value"),
        (spot(wavelength_m=0.03, frequency_hz=5e9), "bad-value"),
        (member("bbox", [0.0, 1.0]), "bad-value"),
        (member("bbox", [0.0, 0.0, 0.01, 0.01]), "bbox-too-small"),
    ],
)
def test_what_is_read_elsewhere_and_not_here_is_said(document: Document, rule: str) -> None:
    """A property that has a reader, but none as it is used here, is named in a finding."""
    assert rule in [finding.rule for finding in findings(document)]
