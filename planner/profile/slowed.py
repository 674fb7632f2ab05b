"""Passes flown more slowly than the rest of a flight, and the way on which it brakes for them.

An autopilot is told a speed at a place of its mission, and changes to it from there on: so the straight
before a slow pass is told it, too, no more of it than braking takes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from planner.profile.flight import Flight, Stretch, Times
from planner.profile.heights import SAME_M
from planner.route import CollectPass

#: A straight is cut where braking begins only if so much of it is left before.
LEAST_BEFORE_M = 5.0


def slowed(
    flight: Flight,
    passes: Sequence[CollectPass],
    passes_m: Sequence[tuple[float, float]],
    times: Times,
) -> Flight:
    """A flight with the speeds that its passes are limited to; as it is where none is.

    Parameters
    ----------
    passes_m
        Between which distances over the ground each lies.
    """
    if all(each.slow is None for each in passes):
        return flight
    stretches = list(flight.stretches)
    for collect, (from_m, until_m) in zip(passes, passes_m, strict=True):
        if collect.slow is None:
            continue
        within = [
            k
            for k, s in enumerate(stretches)
            if s.segment is not None and from_m - SAME_M < s.at_m + 0.5 * s.ground_m < until_m + SAME_M
        ]
        for k in within:
            stretches[k] = replace(stretches[k], most_m_s=collect.slow.speed_m_s)
        before = within[0] - 1 if within else -1
        if before >= 0:
            braking = _braking(stretches[before], collect.slow.braking_m, collect.slow.speed_m_s)
            stretches[before : before + 1] = braking
    starts_m, starts_s = [0.0], [0.0]
    for stretch, time_s in zip(stretches, times(stretches), strict=True):
        starts_m.append(starts_m[-1] + stretch.length_m)
        starts_s.append(starts_s[-1] + time_s)
    return replace(flight, stretches=tuple(stretches), starts_m=tuple(starts_m), starts_s=tuple(starts_s))


def _braking(stretch: Stretch, braking_m: float, speed_m_s: float) -> list[Stretch]:
    """A straight, its end flown at a speed; as it is where it is none, or of a pass itself."""
    segment = stretch.segment
    if segment is None or segment.kind != "straight" or stretch.collects:
        return [stretch]
    slow = replace(stretch, most_m_s=min(stretch.most_m_s, speed_m_s))
    free_m = stretch.ground_m - braking_m
    if free_m < LEAST_BEFORE_M:
        return [slow]
    part = free_m / stretch.ground_m
    altitude_m = stretch.start_altitude_m + part * (stretch.end_altitude_m - stretch.start_altitude_m)
    there = segment.at(free_m)
    return [
        replace(stretch, segment=replace(segment, length_m=free_m), end_altitude_m=altitude_m),
        replace(
            slow,
            pose=there,
            segment=replace(segment, start=there, length_m=braking_m),
            at_m=stretch.at_m + free_m,
            start_altitude_m=altitude_m,
        ),
    ]
