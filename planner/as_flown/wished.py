"""How finely a camera was to see a region."""

from __future__ import annotations

import math
from collections.abc import Sequence

from planner.as_flown.passes import PlannedPass
from planner.plan import Plan
from planner.sensors.base import Sensor
from planner.sensors.camera import CameraSensor
from planner.wishes import Region


def wished_gsd_m(region: Region, sensor: Sensor, plan: Plan, passes: Sequence[PlannedPass]) -> float:
    """The largest ground sampled distance that keeps what is wished of a region.

    Where nothing is wished it is the worst that the plan publishes for it; infinite without.
    """
    wishes_m = [wish for wish in (region.gsd_m, region.min_resolution_m) if wish is not None]
    if region.min_niirs is not None and isinstance(sensor, CameraSensor) and sensor.quality is not None:
        wishes_m.append(sensor.quality.largest_gsd_m(region.min_niirs))
    if wishes_m:
        return min(wishes_m)
    mine = {planned.key for planned in passes if region.name in planned.collect.regions}
    planned_m = [print_.gsd_m for print_ in plan.footprints if (print_.vehicle, print_.seq) in mine]
    return max((gsd_m for gsd_m in planned_m if gsd_m is not None), default=math.inf)
