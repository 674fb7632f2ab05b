"""Heights that the planner chooses: where a region asks for quality, or nothing says how high to fly.

The height is the greatest that keeps every wish on the region's lowest ground, so that lanes are fewest; it
is at least ``min_height_m`` over its highest ground, and at most ``max_height_m`` over its lowest. Where the
latter is absent it is not above the collection's ``altitude_m``.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

from planner.geojson.features import LOWEST_M
from planner.geojson.fields import Fields, Findings
from planner.scenario import Scenario
from planner.sensors.sar import SarSensor
from planner.sensors.wanted import UnknownQualityError, Wanted, wanted_of
from planner.wishes import HIGHEST_M, Band, Region

#: Chosen heights are not below this where no ``min_height_m`` says so.
LEAST_M = 10.0
#: A wish is kept where it is by no more than this part.
ROUNDING = 1e-9


@dataclass(frozen=True, slots=True)
class Heights:
    """What a scenario says of heights.

    Parameters
    ----------
    min_m, max_m
        Over ground, of those that the planner chooses; None where not given.
    altitude_given
        Whether the collection has an ``altitude_m``.
    """

    min_m: float | None
    max_m: float | None
    altitude_given: bool

    @classmethod
    def read(cls, top: Fields) -> Heights:
        """From the collection's members."""
        min_m = top.number("min_height_m", None, minimum=LOWEST_M, maximum=HIGHEST_M)
        max_m = top.number("max_height_m", None, minimum=LOWEST_M, maximum=HIGHEST_M)
        if min_m is not None and max_m is not None and min_m > max_m:
            top.wrong(
                "min_height_m",
                f"is {min_m:g}, above max_height_m, {max_m:g}",
                "Exchange them.",
                "out-of-range",
            )
        return cls(min_m, max_m, "altitude_m" in top)

    def decided(self, regions: Iterable[Region]) -> bool:
        """Whether something says, of some region at least, how high it is seen from."""
        return (
            self.altitude_given
            or self.max_m is not None
            or any(given is not None for region in regions for given in (region.altitude_m, *_wishes(region)))
        )

    def choosing(self, region: Region, wanted: tuple[Wanted, ...]) -> bool:
        """Whether the planner is to choose a region's height."""
        return region.altitude_m is None and (bool(wanted) or not self.altitude_given)

    def band(self, regions: Iterable[Region]) -> Band | None:
        """What flights may go up and down in between passes; None where their heights are given."""
        if self.min_m is None and self.max_m is None:
            return None
        chosen = any(
            region.altitude_m is None
            and (not self.altitude_given or any(wish is not None for wish in _wishes(region)))
            for region in regions
        )
        return Band(self.min_m, self.max_m) if chosen else None

    def over_top_m(
        self,
        region: Region,
        scenario: Scenario,
        relief_m: float,
        level_m: float | None,
        findings: Findings,
        beside_m: float = 0.0,
    ) -> float | None:
        """The height chosen for a region over its highest ground; None where none is to be, or may be.

        Parameters
        ----------
        relief_m
            From its lowest to its highest ground.
        level_m
            What is flown over its highest ground where nothing is chosen: its own altitude or the
            collection's; None without either.
        beside_m
            How much lower than its lowest ground that is which passes over it end above.
        """
        if all(sensor.name != region.sensor for sensor in scenario.sensors) and region.sensor is not None:
            return None
        sensor = scenario.sensor_for(region)
        try:
            wanted = wanted_of(region, sensor)
        except UnknownQualityError as error:
            findings.error(region.name, "quality-unknown", error.message, error.fix)
            return None
        if not self.choosing(region, wanted):
            if level_m is not None:
                _check_given(region, wanted, level_m + relief_m, sensor.name, findings)
                # What follows the ground is judged by the heights it comes to.
                most_m = level_m if scenario.terrain_following else level_m + relief_m
                self._check_most(region, most_m, findings)
            return None
        least_m = LEAST_M if self.min_m is None else self.min_m
        if scenario.terrain is not None:
            least_m = max(least_m, scenario.over_ground_m) if self.min_m is None else least_m
        most_m = min([each.height_m for each in wanted], default=math.inf) - relief_m
        if self.max_m is not None:
            # Ground beside it takes no height that its own asks for.
            most_m = min(most_m, max(self.max_m - relief_m - beside_m, min(self.max_m - relief_m, least_m)))
        elif level_m is not None:
            most_m = min(most_m, level_m)
        if math.isinf(most_m):
            findings.error(
                region.name,
                "missing-property",
                "has no altitude_m, nor has the collection, and asks for no quality that would decide it",
                "Add altitude_m, or max_height_m for the planner to choose below.",
            )
            return None
        if most_m < least_m * (1.0 - ROUNDING):
            self._refuse(region, wanted, relief_m, level_m, least_m, sensor.name, findings)
            return None
        return max(math.floor(100.0 * min(most_m, HIGHEST_M) + 1e-6) / 100.0, least_m)

    def _check_most(self, region: Region, height_m: float, findings: Findings) -> None:
        """A given altitude is not above what may be flown."""
        if self.max_m is None or height_m <= self.max_m * (1.0 + ROUNDING):
            return
        whose = "the collection's" if region.altitude_m is None else "its own"
        lower_m = math.ceil(10.0 * (height_m - self.max_m)) / 10.0
        findings.error(
            region.name,
            "above-ceiling",
            f"is seen from {height_m:.1f} m over its lowest ground by {whose} altitude_m, and max_height_m "
            f"is {self.max_m:g}",
            f"Lower altitude_m by {lower_m:g} m, leave it out, or give max_height_m {math.ceil(height_m):g} "
            "or more.",
        )

    def _refuse(
        self,
        region: Region,
        wanted: tuple[Wanted, ...],
        relief_m: float,
        level_m: float | None,
        least_m: float,
        sensor: str,
        findings: Findings,
    ) -> None:
        lowest = f"{least_m:g} m over its highest ground"
        if relief_m > 0.0:
            lowest += f", {least_m + relief_m:.1f} m over its lowest"
        over_m = least_m + relief_m
        strict = min(wanted, key=lambda each: each.height_m, default=None)
        if strict is not None and strict.height_m < over_m * (1.0 - ROUNDING):
            more = "less" if strict.wish == "min_niirs" else "more"
            gives = f"up to {strict.height_m:.1f} m" if strict.height_m > 0.0 else "from no height"
            lower = ", or lower min_height_m" if self.min_m is not None else ", or set min_height_m"
            lower = lower if strict.height_m > 0.0 else ""
            findings.error(
                region.name,
                "quality-out-of-reach",
                f"asks for {strict.wish} {strict.asked:g}, which {sensor} gives {gives}; the lowest flight "
                f"allowed is {lowest}",
                f"Give {strict.wish} {strict.allowed(over_m):.10g} or {more}{lower}.",
            )
            return
        if self.max_m is None:
            findings.error(
                region.name,
                "heights-too-close",
                f"is to be seen from {lowest} at least, and altitude_m is {level_m or 0.0:g} m up there",
                f"Give max_height_m {math.ceil(over_m):g} or more, or min_height_m lower.",
            )
            return
        findings.error(
            region.name,
            "heights-too-close",
            f"rises by {relief_m:.1f} m: no level is {least_m:g} m over its highest ground and within "
            f"max_height_m, {self.max_m:g} m, over its lowest",
            f"Give max_height_m {math.ceil(over_m):g} or more, lower min_height_m, or divide it by height.",
        )


def _wishes(region: Region) -> tuple[float | None, ...]:
    return region.gsd_m, region.min_niirs, region.min_resolution_m


def _check_given(
    region: Region, wanted: tuple[Wanted, ...], height_m: float, sensor: str, findings: Findings
) -> None:
    """A region's own altitude gives what it asks for."""
    for each in wanted:
        if height_m <= each.height_m * (1.0 + ROUNDING):
            continue
        more = "less" if each.wish == "min_niirs" else "more"
        lower_m = math.ceil(10.0 * (height_m - each.height_m)) / 10.0
        helps = f"Lower its altitude_m by {lower_m:g} m, or leave it out; or " if each.height_m > 0.0 else ""
        findings.error(
            region.name,
            "quality-out-of-reach",
            f"asks for {each.wish} {each.asked:g}, and from its altitude_m, {height_m:.1f} m over its lowest "
            f"ground, {sensor} gives {each.given(height_m):.4g}",
            f"{helps}give {each.wish} {each.allowed(height_m):.10g} or {more}.",
        )


def with_wishes(scenario: Scenario) -> Scenario:
    """What radars resolve does not depend on their height: of them ``gsd_m`` asks for a resolution."""
    known = {sensor.name for sensor in scenario.sensors}
    regions = []
    for region in scenario.regions:
        asked = [m for m in (region.gsd_m, region.min_resolution_m) if m is not None]
        radar = (region.sensor is None or region.sensor in known) and isinstance(
            scenario.sensor_for(region), SarSensor
        )
        regions.append(replace(region, min_resolution_m=min(asked)) if radar and asked else region)
    return replace(scenario, regions=tuple(regions))


def at_chosen_heights(scenario: Scenario, heights: Heights, findings: Findings) -> Scenario:
    """Over flat ground: each region that heights are chosen for at its own; see ``relief`` for terrain."""
    ground_m = (scenario.home_amsl_m or 0.0) if scenario.altitude_reference == "amsl" else 0.0
    regions = []
    for region in scenario.regions:
        given_m = region.altitude_m
        if given_m is None and heights.altitude_given:
            given_m = scenario.altitude_m
        level_m = None if given_m is None else given_m - ground_m
        chosen_m = heights.over_top_m(region, scenario, 0.0, level_m, findings)
        regions.append(region if chosen_m is None else replace(region, altitude_m=ground_m + chosen_m))
    return at_highest(replace(scenario, regions=tuple(regions)), heights)


def at_highest(scenario: Scenario, heights: Heights) -> Scenario:
    """Without an altitude of the collection, the highest of its regions' is flown between them."""
    altitudes_m = [region.altitude_m for region in scenario.regions if region.altitude_m is not None]
    if heights.altitude_given or not altitudes_m:
        return scenario
    return replace(scenario, altitude_m=max(altitudes_m))


def tell_unused(scenario: Scenario, heights: Heights, findings: Findings) -> None:
    """``min_height_m`` is for regions whose height is chosen."""
    asking = any(wish is not None for region in scenario.regions for wish in _wishes(region))
    if heights.min_m is not None and heights.altitude_given and not asking:
        findings.warning(
            "scenario",
            "not-used",
            "min_height_m bounds heights that the planner chooses, and altitude_m decides all of them",
            "Leave min_height_m or altitude_m out, or have a region ask for quality.",
        )
