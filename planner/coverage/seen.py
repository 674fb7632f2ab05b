"""Whether all that is asked for can be seen, found sooner than the targets of a tour are."""

from __future__ import annotations

from dataclasses import replace

from planner.airspace.surroundings import Surroundings
from planner.coverage.merge import MergedRegion, merge_regions
from planner.coverage.registry import family_of
from planner.coverage.visible import Seeing
from planner.errors import InfeasibleError
from planner.wishes import Region


def check_visible(asked: Seeing, around: Surroundings) -> None:
    """Refuse what ``Seeing.visible`` refuses, for its reason.

    Raises
    ------
    InfeasibleError
        Where a required region cannot be seen.
    """
    merged = merge_regions(asked.regions, default_sensor=asked.suite.first)
    by_name = {region.name: region for region in asked.regions}

    def seen(region: MergedRegion) -> bool:
        return _seen(asked, region, [by_name[name] for name in region.names], around)

    doubtful = {name for region in merged if not seen(region) for name in region.names}
    if not doubtful:
        return
    # Those that one of them is merged with, and so on, so that they are merged as they are among all.
    while True:
        more = {name for region in merged if doubtful.intersection(region.names) for name in region.names}
        if more <= doubtful:
            break
        doubtful |= more
    left = tuple(region for region in asked.regions if region.name in doubtful)
    replace(asked, regions=left).visible(around)


def _seen(asked: Seeing, region: MergedRegion, parts: list[Region], around: Surroundings) -> bool:
    """Whether some passes that see a region whole may be flown; False says nothing.

    Parameters
    ----------
    parts
        What was merged to it, in the order of its names.
    """
    try:
        level = asked.level.of(region)
        sensor, height_m = asked.suite.over(parts[0].sensor, region.area, asked.airspace, level)
        family = family_of(sensor)
        for each in parts:
            family.check(each, sensor, height_m)
        return family.can_be_flown(region, sensor, height_m, asked.at(level, around), wide=asked.wide)
    except InfeasibleError:
        return False
