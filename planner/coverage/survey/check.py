"""What of a camera makes lanes impossible whatever the region's shape."""

from __future__ import annotations

import numpy as np

from planner.coverage.survey.frame import frames
from planner.errors import InfeasibleError
from planner.sensors.camera import CameraSensor
from planner.wishes import Region


def check_camera(name: str, sensor: CameraSensor, height_m: float) -> None:
    """Refuse a height from which overlaps cannot be kept.

    Raises
    ------
    InfeasibleError
        ``"height"`` not above the ground seen; ``"overlap"`` where the margins leave nothing.
    """
    if height_m <= sensor.relief_m:
        raise InfeasibleError(
            "height",
            name,
            f"{height_m:.0f} m over its mean ground is not over the highest, {sensor.relief_m:.0f} m up",
            "fly higher, or divide the region by height",
        )
    still = sensor.in_wind(0.0, 0.0)
    if not frames(still, height_m, np.zeros(1)).good[0]:
        raise InfeasibleError(
            "overlap",
            name,
            f"the margins of camera {sensor.name}, {sensor.margin_m(height_m):.1f} m to either side, leave "
            f"nothing of its overlaps from {height_m:.0f} m",
            "fly higher, or lower pointing_margin_deg, position_margin_m or the overlaps",
        )


def check_pattern(region: Region, sensor: CameraSensor) -> None:
    """Refuse a pattern that goes with no such camera.

    Raises
    ------
    InfeasibleError
        ``"pattern"``: a look ahead from a camera that looks straight down, a spiral from one that does not;
        ``"approach"``: headings for what is flown all round.
    """
    if region.pattern in ("orbit", "spiral") and region.approach_rad is not None:
        raise InfeasibleError(
            "approach",
            region.name,
            f"has headings to be flown along, and the pattern {region.pattern} is flown along all of them",
            "leave approach_deg out, or take the pattern lanes",
        )
    if region.pattern == "look" and sensor.tilt_rad == 0.0:
        raise InfeasibleError(
            "pattern",
            region.name,
            f"asks for a look from ahead, and camera {sensor.name} looks straight down",
            "tilt it (tilt_deg 45, say), or take the pattern lanes",
        )
    if region.pattern == "spiral" and sensor.tilt_rad != 0.0:
        raise InfeasibleError(
            "pattern",
            region.name,
            f"asks for a spiral over it, and camera {sensor.name} is tilted and looks past it",
            "leave tilt_deg out, or take the pattern orbit",
        )
