"""No property is accepted that nothing reads: each changes the plan, the mission, a finding or a refusal."""

from __future__ import annotations

import contextlib
import functools
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
from tests.planner.geojson.proof_scenarios import (
    EXTRA,
    Document,
    member,
    of_feature,
    sensor,
    spot,
    threat,
    vehicle,
    with_features,
)
from tests.planner.geojson.proofs import PROOFS
from tests.planner.scenarios import small
from tests.planner.terrains import raster

#: The members of a plan that only repeat what was asked.
ECHOES = ("scenario_hash", "methods", "vehicles", "altitude_m", "altitude_reference")


def hill() -> dict[str, Terrain]:
    """A raster with a hill between the regions."""
    frame = read_scenario(small()).frame
    return {"hill": raster(lambda e, n: 900.0 * np.exp(-((e - 1500.0) ** 2 + (n - 500.0) ** 2) / 5e5), frame)}


def outcome(document: Document) -> str:
    """Everything a client gets of a scenario, echoes and times left out."""
    return _outcome(json.dumps(document))


@functools.cache
def _outcome(text: str) -> str:
    """The same of its text: many proofs begin with the same scenario."""
    document = json.loads(text)
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


#: Members that hold the others, and what says which reader reads a feature.
STRUCTURE = {
    ("scenario", name)
    for name in (
        "type",
        "features",
        "vehicles",
        "sensors",
        "wind",
        "objective",
        "method",
        "separation",
        "replan",
    )
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
