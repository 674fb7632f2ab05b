"""Methods of coverage among obstacles by name: an area in, a flight, or sweeps in order, out."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from planner.coverage.urban.alternatives import CoverageAlternatives
from planner.coverage.urban.area import UrbanArea
from planner.coverage.urban.auto import Auto
from planner.coverage.urban.bcdh import BoustrophedonCells
from planner.coverage.urban.majeed import Majeed2019
from planner.coverage.urban.measures import Flown, Sweep
from planner.coverage.urban.waypoints import Joiner

METHODS: Mapping[str, Callable[[UrbanArea], Flown]] = MappingProxyType(
    {
        "auto": Auto(),
        "majeed2019": Majeed2019(),
        "majeed2019-highs": Majeed2019("highs"),
        "boustrophedon-cells": BoustrophedonCells(),
        "coverage-alternatives": CoverageAlternatives(),
    }
)

#: Sweeps in the order and direction flown: of an area with its free ground, and a seed.
Sequence = Callable[[UrbanArea, Joiner, int], tuple[Sweep, ...]]

#: What ``method.coverage`` may ask for; ``auto`` takes its own where obstacles cut a region.
SEQUENCES: Mapping[str, Sequence] = MappingProxyType(
    {
        "auto": lambda urban, joiner, seed: Auto(seed).sequence(urban, joiner),
        "majeed2019": lambda urban, joiner, seed: Majeed2019(seed=seed).sequence(urban, joiner.free),
        "boustrophedon-cells": lambda urban, joiner, _: BoustrophedonCells().sequence(urban, joiner.free),
        "coverage-alternatives": lambda urban, joiner, _: CoverageAlternatives().sequence(
            urban, joiner.free, joiner
        ),
    }
)
