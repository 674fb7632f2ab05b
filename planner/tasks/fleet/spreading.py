"""Jobs of regions with the ways to do them: cut where they are to be, whole where a part cannot be done."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from planner.errors import Finding, InfeasibleError
from planner.tasks.fleet.crews import Crew, ways_of
from planner.tasks.fleet.flights import in_best_order
from planner.tasks.fleet.jobs import Job, jobs_of
from planner.tasks.fleet.ways import Ways
from planner.tasks.task import Controls
from planner.tasks.urban import cut_by_obstacles
from planner.wishes import Region

#: Of a region and a kind of crew its way by itself alone, or why there is none.
Known = dict[tuple[Region, tuple[object, ...]], Ways | InfeasibleError]


@dataclass(frozen=True, slots=True)
class Spread:
    """Jobs, their ways by their names and the numbers of crews, why some have none, and in how many parts."""

    jobs: tuple[Job, ...]
    ways: dict[tuple[str, int], Ways]
    why: dict[str, Finding]
    parts: dict[str, int]


def spread(
    crews: Sequence[Crew],
    regions: Sequence[Region],
    parts: Mapping[str, int],
    shared_m: Mapping[str, float],
    controls: Controls,
    known: Known,
) -> Spread:
    """Regions cut in so many parts, but for those of which a part has no way.

    Parameters
    ----------
    known
        What was found by itself alone, which takes long; added to.

    Raises
    ------
    InfeasibleError
        Where a required region has none.
    """
    parts = dict(parts)

    def instead(crew: Crew, job: Job) -> Ways:
        key = (job.asked, crew.kind)
        if key not in known:
            try:
                known[key] = _alone(crew, job, controls)
            except InfeasibleError as error:
                known[key] = error
        found = known[key]
        if isinstance(found, InfeasibleError):
            raise found
        return found

    while True:
        jobs = jobs_of(regions, parts, shared_m)
        cut = {job.region.name: job.of for job in jobs if job.region.name != job.of}
        try:
            ways, why = ways_of(crews, jobs, instead)
        except InfeasibleError as error:
            if not cut:
                raise
            lost = {cut[error.feature]} if error.feature in cut else set(cut.values())
        else:
            lost = {cut[name] for name in why if name in cut}
            if not lost:
                return Spread(jobs, ways, why, parts)
        parts |= dict.fromkeys(lost, 1)


def _alone(crew: Crew, job: Job, controls: Controls) -> Ways:
    """The one way that its aircraft flies a job by itself among obstacles, of which no pass sees it whole.

    Raises
    ------
    InfeasibleError
        Where there is none.
    """
    if not cut_by_obstacles(replace(crew.asked, regions=(job.asked,))):
        raise InfeasibleError("transit", job.of, "no obstacle is in the way", "")
    flown = in_best_order(crew, 0, [(job, 0)], controls)
    passes, along_m = flown.order.passes, flown.composed.passes_m
    settle_m = crew.setting.model.settle_m
    begin, end = passes[0].settling(settle_m), passes[-1].exit
    entry, leave = ([*pose.position, pose.angle_rad] for pose in (begin, end))
    inner_m = along_m[-1][1] - along_m[0][0] + settle_m
    return Ways(np.array([entry]), np.array([leave]), np.array([inner_m]))
