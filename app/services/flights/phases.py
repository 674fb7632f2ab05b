"""When a flight went from one phase of its plan to the next, as recorded."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from app.services.records import TrackSample
from planner.frames import LocalFrame
from planner.plan import FlownPath, LonLatAlt, PhaseKind

#: From this height over home on it flies; below it, behind the last phase before the landing, it has landed.
OFF_GROUND_M = 1.0
#: A boundary that was passed no nearer than this was not passed.
NEAR_M = 150.0
#: Times at which a place is passed this much farther off count as passing it, too.
AS_NEAR_M = 10.0
#: A record that begins higher over home began in the air.
IN_THE_AIR_M = 10.0
#: Who has come a smaller part of a phase's way has not flown it, though it was near the place where it ends.
LEAST_PART = 0.5


@dataclass(frozen=True, slots=True)
class FlownPhase:
    """A phase's duration as planned and as flown; None where its beginning or end was not recorded."""

    kind: PhaseKind
    planned_s: float
    flown_s: float | None


def flown_phases(
    path: FlownPath, samples: Sequence[TrackSample], home_altitude_m: float | None = None
) -> tuple[FlownPhase, ...]:
    """Durations of the phases of a path, as planned and as flown.

    A phase ends when the track comes nearest, in three dimensions, to where its end is planned, behind the
    end of the phase before; of several times at the one planned. The first begins as the aircraft leaves the
    ground; a landing ends as it is back. Who joined a plan in the air flew neither its take-off nor its
    climb; who left it did not end the phase that it was in.

    Parameters
    ----------
    home_altitude_m
        Of home, in the path's own heights, where the path begins in the air; None where it begins at home.
    """
    flown = [sample for sample in samples if sample.altitude_home_m is not None]
    off_ground = [s.time_s for s in flown if (s.altitude_home_m or 0.0) > OFF_GROUND_M]
    if not (flown and off_ground and path.phases):
        return tuple(FlownPhase(phase.kind, phase.end_s - phase.start_s, None) for phase in path.phases)
    frame = LocalFrame(*path.line[0][:2])
    ground_m = path.line[0][2] if home_altitude_m is None else home_altitude_m
    heights_m = np.array([s.altitude_home_m for s in flown], dtype=np.float64)
    places = np.column_stack([frame.to_local([(s.lon_deg, s.lat_deg) for s in flown]), heights_m])
    times_s = np.array([s.time_s for s in flown])
    way_m = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(places, axis=0), axis=1))])
    found: list[FlownPhase] = []
    joined = home_altitude_m is None and heights_m[0] > IN_THE_AIR_M
    begun_s: float | None = None if joined else off_ground[0]
    after_s = off_ground[0]
    for phase in path.phases:
        if phase.kind == "landing":
            ended_s = _landed_s(flown, after_s)
        elif joined and phase.kind in ("take_off", "climb"):
            ended_s = None
        else:
            place = _place_at(path, phase.end_m)
            local = np.array([*frame.to_local([place[:2]])[0], place[2] - ground_m])
            ended_s = _passed_s(times_s, places, local, after_s, after_s + phase.end_s - phase.start_s)
            if begun_s is not None and ended_s is not None:
                come_m = float(np.diff(np.interp([begun_s, ended_s], times_s, way_m))[0])
                least_m = LEAST_PART * (phase.end_m - phase.start_m) - AS_NEAR_M
                ended_s = ended_s if come_m >= least_m else None
        flown_s = None if begun_s is None or ended_s is None else ended_s - begun_s
        found.append(FlownPhase(phase.kind, phase.end_s - phase.start_s, flown_s))
        begun_s, after_s = ended_s, after_s if ended_s is None else ended_s
    return tuple(found)


def _passed_s(
    times_s: NDArray[np.float64],
    places: NDArray[np.float64],
    place: NDArray[np.float64],
    after_s: float,
    planned_s: float,
) -> float | None:
    """When a place was passed; of several times as near to it, the one nearest to when it was planned.

    What takes off and lands at one place passes each height over it twice.
    """
    away_m = np.where(times_s >= after_s, np.linalg.norm(places - place, axis=1), math.inf)
    if not away_m.min() <= NEAR_M:
        return None
    near = np.concatenate([[False], away_m <= away_m.min() + AS_NEAR_M, [False]])
    edges = np.flatnonzero(np.diff(near.astype(np.int8)))
    passed = [
        first + int(np.argmin(away_m[first:last]))
        for first, last in zip(edges[::2], edges[1::2], strict=True)
    ]
    return float(min((times_s[k] for k in passed), key=lambda at_s: abs(float(at_s) - planned_s)))


def _landed_s(flown: Sequence[TrackSample], after_s: float) -> float | None:
    low = [s.time_s for s in flown if s.time_s > after_s and (s.altitude_home_m or 0.0) < OFF_GROUND_M]
    return low[0] if low else None


def _place_at(path: FlownPath, along_m: float) -> LonLatAlt:
    """The place where a segment ends at a distance along the path."""
    segment = min(path.segments, key=lambda s: abs(s.start_m + s.length_m - along_m))
    return (*segment.end, segment.end_altitude_m)
