"""The network of segments as GeoJSON, by role: targets, segments, ingress and egress points."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from planner.errors import Finding
from planner.route import Pose
from planner.scenario import Scenario
from planner.tasks.network.segments import Looked, Network, RecognitionSegment

#: A ten-millionth of a degree is a centimetre.
DECIMALS_DEG = 7


def write_network(scenario: Scenario, network: Network) -> dict[str, Any]:
    """A FeatureCollection with a feature of role ``segment`` for each, and its points beside it.

    Segments are numbered through for each target, those that were chosen first.
    """
    counts: dict[str, int] = {}
    features = [_target(scenario, name, own) for name, own in _by_target(network.looked).items()]
    for segment in network.segments:
        counts[segment.target] = counts.get(segment.target, 0) + 1
        features += _segment(scenario, segment, f"{segment.target}-{counts[segment.target]}")
    return {
        "type": "FeatureCollection",
        "name": scenario.name,
        "features": features,
        "heading_step_deg": round(math.degrees(network.step_rad), 6),
        "stand_offs": network.stand_offs,
        "altitude_reference": scenario.altitude_reference,
        "scenario_hash": scenario.scenario_hash,
    }


def _by_target(looked: Iterable[Looked]) -> dict[str, list[Looked]]:
    found: dict[str, list[Looked]] = {}
    for each in looked:
        found.setdefault(each.target, []).append(each)
    return found


def _target(scenario: Scenario, name: str, looked: Iterable[Looked]) -> dict[str, Any]:
    region = next(each for each in scenario.regions if each.name == name)
    middle = region.area.representative_point()
    sensors = [
        {
            "sensor": each.sensor,
            "vehicles": list(each.vehicles),
            "asked": each.asked,
            "meets_quality": each.refused is None,
            "ruled_out": [] if each.refused is None else [_finding(each.refused)],
        }
        for each in looked
    ]
    properties = {
        "role": "target",
        "target": name,
        "priority": region.priority,
        "required": region.required,
        "time_window_s": None if region.time_window_s is None else list(region.time_window_s),
        "sensors": sensors,
    }
    return _feature(name, "Point", _place(scenario, (middle.x, middle.y)), properties)


def _segment(scenario: Scenario, segment: RecognitionSegment, name: str) -> Iterable[dict[str, Any]]:
    heights = (segment.altitude_m,)
    lines = [[[*_place(scenario, place), *heights] for place in line] for line in segment.lines]
    properties = {
        "role": "segment",
        "target": segment.target,
        "sensor": segment.sensor,
        "look": segment.look,
        "heading_deg": _heading(scenario, Pose(*segment.lines[0][0], segment.angle_rad)),
        "vehicles": list(segment.vehicles),
        "passes": len(segment.lines),
        "length_m": round(segment.length_m, 2),
        "stand_off_m": round(segment.stand_off_m, 2),
        "seen": None if segment.seen is None else round(segment.seen, 6),
        "resolution_m": segment.resolution_m,
        "gsd_m": segment.worth.gsd_m,
        "niirs": segment.worth.niirs,
        "risk_missile": segment.risk_missile,
        "risk_radar": segment.risk_radar,
        "room_to_turn": segment.turns,
        "state": segment.state,
        "chosen": segment.state == "chosen",
        "longer_m": None if segment.longer_m is None else round(segment.longer_m, 1),
        "ruled_out": [_finding(each) for each in segment.ruled_out],
    }
    if segment.sortie is not None:
        properties["sortie"] = segment.sortie
    single = len(lines) == 1
    yield _feature(
        name, "LineString" if single else "MultiLineString", lines[0] if single else lines, properties
    )
    for role, pose in (("ingress", segment.ingress), ("egress", segment.egress)):
        yield _feature(
            f"{name} {role}",
            "Point",
            [*_place(scenario, pose.position), *heights],
            {
                "role": role,
                "segment": name,
                "target": segment.target,
                "state": segment.state,
                "heading_deg": _heading(scenario, pose),
            },
        )


def _finding(finding: Finding) -> dict[str, str]:
    return {
        "feature": finding.feature, "rule": finding.rule, "message": finding.message, "fix": finding.fix
    }  # fmt: skip


def _heading(scenario: Scenario, pose: Pose) -> float:
    frame = scenario.frame
    return round(float(frame.true_heading_deg(*pose.position, pose.angle_rad)), 3)


def _place(scenario: Scenario, place: tuple[float, float]) -> list[float]:
    lon_deg, lat_deg = (float(value) for value in scenario.frame.to_wgs84(place))
    return [round(lon_deg, DECIMALS_DEG), round(lat_deg, DECIMALS_DEG)]


def _feature(name: str, kind: str, coordinates: Any, properties: dict[str, Any]) -> dict[str, Any]:
    geometry = {"type": kind, "coordinates": coordinates}
    return {"type": "Feature", "id": name, "properties": properties, "geometry": geometry}
