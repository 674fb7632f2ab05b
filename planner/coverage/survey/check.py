"""What of a camera makes lanes impossible whatever the region's shape."""

from __future__ import annotations

import numpy as np

from planner.coverage.survey.frame import frames
from planner.errors import InfeasibleError
from planner.sensors.camera import CameraSensor


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
