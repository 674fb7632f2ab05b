"""Methods of coverage among obstacles by name: an area in, a flight, or sweeps in order, out."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from planner.coverage.urban.alternatives import CoverageAlternatives
from planner.coverage.urban.area import UrbanArea
from planner.coverage.urban.auto import Auto
from planner.coverage.urban.bcdh import BoustrophedonCells
from planner.coverage.urban.free import FreeSpace
from planner.coverage.urban.majeed import Majeed2019
from planner.coverage.urban.measures import Flown, Sweep

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
Sequence = Callable[[UrbanArea, FreeSpace, int], tuple[Sweep, ...]]

#: What ``method.coverage`` may ask for; ``auto`` takes its own where obstacles cut a region.
SEQUENCES: Mapping[str, Sequence] = MappingProxyType(
    {
        "auto": lambda urban, free, seed: Auto(seed).sequence(urban, free),
        "majeed2019": lambda urban, free, seed: Majeed2019(seed=seed).sequence(urban, free),
        "boustrophedon-cells": lambda urban, free, _: BoustrophedonCells().sequence(urban, free),
        "coverage-alternatives": lambda urban, free, _: CoverageAlternatives().sequence(urban, free),
    }
)
