"""What a worker loads. Sending it a function loads the module around that, so it has one of its own."""

from __future__ import annotations

import os
import sys
from pathlib import Path

OURS = ("app", "planner", "mavlink", "numba", "numpy", "scipy", "shapely", "pyproj")


def loaded_by_an_upload(plan_file: str) -> tuple[list[str], int]:
    """What an upload loads beside what is there already, and the worker's niceness."""
    before = set(sys.modules)
    from app.services.plans.missions import MissionChoice
    from app.services.vehicles.brief import brief_of

    brief_of(Path(plan_file).read_text(), '{"features": []}', MissionChoice())
    new = (name for name in set(sys.modules) - before if name.partition(".")[0] in OURS)
    return sorted(new), os.getpriority(os.PRIO_PROCESS, 0)
