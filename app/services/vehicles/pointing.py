"""A mission's gimbal against the sensor its plan was made for: what is held aside is not seen."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from mavlink.dialects.mission import Mission
from mavlink.rules.table import Needs
from planner.errors import Finding
from planner.plan import Plan, PlanCamera

#: ArduPilot keeps whole degrees, which may be half of one off.
_TILT_WITHIN_DEG = 0.51


def pointing_findings(
    plan: Plan, scenario: Mapping[str, Any], mission: Mission, needs: Needs
) -> tuple[Finding, ...]:
    """What does not fit; nothing where the sensor is bolted on.

    Parameters
    ----------
    scenario
        As it was posted: there a radar says where its beam looks (``incidence_deg``, from straight down), and
        whether it is kept abeam of the course (``stabilised``).
    """
    return tuple(_findings(plan, scenario, mission, needs))


def _findings(plan: Plan, scenario: Mapping[str, Any], mission: Mission, needs: Needs) -> Iterator[Finding]:
    gimbal = needs.gimbal
    if gimbal is None:
        return
    tilt_deg = 90.0 + gimbal.pitch_deg
    used = {collect.sensor for collect in plan.collects_of(mission.vehicle)}
    windy = _speed_m_s(scenario.get("wind")) > 0.0
    for sensor in scenario.get("sensors") or ():
        name, incidence_deg = sensor.get("name"), sensor.get("incidence_deg")
        if name in used and (camera := plan.camera(str(name))) is not None:
            yield from _camera_findings(camera, tilt_deg)
        if name not in used or sensor.get("type") != "sar" or incidence_deg is None:
            continue
        if abs(incidence_deg - tilt_deg) > _TILT_WITHIN_DEG:
            yield Finding(
                f"sensor {name}",
                "gimbal-tilt",
                f"the plan has the beam {incidence_deg:g}° from straight down, the gimbal would hold it at"
                f" {tilt_deg:g}°",
                f"write tilt={incidence_deg:g}, or leave the gimbal out where the radar is bolted on",
            )
        if windy and bool(sensor.get("stabilised", False)) != (gimbal.hold == "course"):
            yield _yaw_finding(str(name), follows_nose=gimbal.hold == "vehicle")


def _camera_findings(camera: PlanCamera, tilt_deg: float) -> Iterator[Finding]:
    planned_deg = abs(camera.tilt_deg)
    if abs(planned_deg - tilt_deg) > _TILT_WITHIN_DEG:
        yield Finding(
            f"sensor {camera.name}",
            "gimbal-tilt",
            f"the plan has the camera {planned_deg:g}° from straight down, the gimbal would hold it at"
            f" {tilt_deg:g}°",
            f"write tilt={planned_deg:g}, or leave the gimbal out where the camera is bolted on",
        )


def _yaw_finding(name: str, *, follows_nose: bool) -> Finding:
    if follows_nose:
        message = "the plan has the antenna kept abeam of the course, the gimbal would turn it with the nose"
        fix = "write yaw=course, or plan with stabilised false"
    else:
        message = "the plan has the antenna turn with the nose, the gimbal would keep it abeam of the course"
        fix = "write yaw=vehicle, or plan with stabilised true"
    return Finding(f"sensor {name}", "gimbal-yaw", message, fix, severity="warning")


def _speed_m_s(wind: Any) -> float:
    return float(wind.get("speed_m_s", 0.0)) if isinstance(wind, Mapping) else 0.0
