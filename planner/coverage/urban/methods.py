"""Methods of coverage among obstacles by name: an area in, a flight out."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from planner.coverage.urban.alternatives import CoverageAlternatives
from planner.coverage.urban.area import UrbanArea
from planner.coverage.urban.auto import Auto
from planner.coverage.urban.bcdh import BoustrophedonCells
from planner.coverage.urban.majeed import Majeed2019
from planner.coverage.urban.measures import Flown

METHODS: Mapping[str, Callable[[UrbanArea], Flown]] = MappingProxyType(
    {
        "auto": Auto(),
        "majeed2019": Majeed2019(),
        "majeed2019-highs": Majeed2019("highs"),
        "boustrophedon-cells": BoustrophedonCells(),
        "coverage-alternatives": CoverageAlternatives(),
    }
)
