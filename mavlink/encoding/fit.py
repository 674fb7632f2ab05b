"""A fence that fits into what an autopilot stores: corners thinned to the safe side, far zones left out.

A thinned zone holds the whole of the zone that was asked for, and a thinned area lies within its own: the
aircraft is let nowhere that it was not let before. Neither comes nearer to the flight than ``ROOM_M``, or
than the shape as drawn does, so that the fence does not stop the flight that it was made for.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from mavlink.dialects.stores import FenceStore

#: Corners are thinned by these, the least that is enough: no thinned edge is farther from the drawn one.
THINNED_M = (
    0.5,
    1.0,
    2.0,
    3.0,
    5.0,
    7.0,
    10.0,
    15.0,
    20.0,
    25.0,
    30.0,
    40.0,
    50.0,
    70.0,
    100.0,
    150.0,
    200.0,
)
#: Kept between a thinned edge and the flight, where the drawn one is no nearer.
ROOM_M = 15.0
#: What has so many corners, all so near to a circle by its radius, was drawn for one.
ROUND_CORNERS, ROUND_PART = 16, 0.05
#: How well lines are kept, passes and what is behind turns alike.
KEPT_TO_M = 5.0
#: Zones farther from the whole flight than this may be left out of a fence that is still too large.
FAR_M = 5_000.0


@dataclass(frozen=True, slots=True)
class Piece:
    """One shape of a fence in local metres: a polygon to stay in or out of, or a circle to stay out of.

    Parameters
    ----------
    corners
        Of the polygon; 0 for a circle.
    thinned_m
        So far at most its edges are from the drawn ones.
    radius_m
        Of a circle that a polygon of many corners became, about the middle of its shape.
    """

    name: str
    shape: Polygon
    inside: bool = False
    corners: int = 0
    thinned_m: float = 0.0
    radius_m: float | None = None

    @classmethod
    def polygon(cls, name: str, shape: Polygon, inside: bool) -> Piece:
        """An area to stay in (``inside``), or a zone to stay out of."""
        return cls(name, shape, inside, len(shape.exterior.coords) - 1)

    @property
    def round(self) -> bool:
        """Whether it is a circle."""
        return self.corners == 0


def fitted(
    pieces: Sequence[Piece], lines: Sequence[LineString], store: FenceStore | None
) -> tuple[tuple[Piece, ...], tuple[str, ...]]:
    """The pieces that go on board, and notes on what was changed.

    Parameters
    ----------
    lines
        All that is flown.
    store
        What the autopilot stores of a fence; None where that is not known.
    """
    flown = shapely.union_all(list(lines))
    kept, notes = _within(pieces)
    if store is None or _fits(kept, store):
        return tuple(kept), tuple(notes)
    drawn = kept
    for by_m in THINNED_M:
        kept = [_thinner(piece, now, by_m, flown) for piece, now in zip(drawn, kept, strict=True)]
        if _fits(kept, store):
            break
    kept, far = _without_far(kept, flown, store)
    notes += _thinned_notes(kept, store) + far
    if not _fits(kept, store):
        notes.append(does_not_fit(kept, store))
    return tuple(kept), tuple(notes)


def near_notes(pieces: Iterable[Piece], lines: Sequence[LineString]) -> tuple[str, ...]:
    """A note on each fence that the flight, flown as well as autopilots fly, may meet."""
    flown = shapely.union_all(list(lines))
    found = [(float(flown.distance(piece.shape.exterior)), piece.name) for piece in pieces]
    return tuple(
        f"fence: the flight comes to {near_m:.1f} m from the edge of {name!r}; lines are kept to some "
        f"{KEPT_TO_M:g} m, so the fence may stop it: plan with more clearance_m, or a wider area"
        for near_m, name in sorted(found)
        if near_m < KEPT_TO_M
    )


def does_not_fit(pieces: Iterable[Piece], store: FenceStore) -> str:
    """What is said of a fence that is too large after all that could be done."""
    lacks = store.lacks(*_sizes(pieces))
    return f"fence: does not fit, {lacks}: draw zones with fewer corners, or leave some out"


def _sizes(pieces: Iterable[Piece]) -> tuple[list[int], int]:
    """Corners of each polygon, and how many circles."""
    listed = list(pieces)
    return [piece.corners for piece in listed if not piece.round], sum(piece.round for piece in listed)


def _fits(pieces: Iterable[Piece], store: FenceStore) -> bool:
    return store.holds(*_sizes(pieces))


def _within(pieces: Sequence[Piece]) -> tuple[list[Piece], list[str]]:
    """Without zones that lie wholly outside an area that is to be stayed in."""
    areas = [piece.shape for piece in pieces if piece.inside]
    if not areas:
        return list(pieces), []
    room = shapely.intersection_all(areas)
    shapely.prepare(room)
    kept = [piece for piece in pieces if piece.inside or room.intersects(piece.shape)]
    away = [piece.name for piece in pieces if not piece.inside and not room.intersects(piece.shape)]
    if not away:
        return kept, []
    return kept, [f"fence: {_named(away)} outside the operating area, which is the fence itself: left out"]


def _thinner(piece: Piece, now: Piece, by_m: float, flown: BaseGeometry) -> Piece:
    """The drawn piece with fewer corners than now within a distance, where that leaves the flight alone."""
    if piece.round or piece.corners <= 3:
        return piece
    shape = thinned(piece.shape, by_m, inside=piece.inside)
    radius_m = None if piece.inside else circle_round_m(piece.shape, by_m)
    if radius_m is not None:
        # One point, whatever corners it was drawn with.
        shape = piece.shape.centroid.buffer(radius_m, quad_segs=32)
    corners = 0 if radius_m is not None or shape is None else len(shape.exterior.coords) - 1
    if shape is None or now.round or corners >= now.corners:
        return now
    if piece.inside:
        near_m, left_m = (float(flown.distance(area.exterior)) for area in (piece.shape, shape))
        clear = shape.covers(flown)
    else:
        near_m, left_m = (float(flown.distance(zone)) for zone in (piece.shape, shape))
        clear = not flown.intersects(shape)
    if not flown.is_empty and not (clear and left_m >= min(near_m, ROOM_M)):
        return now
    return replace(piece, shape=shape, corners=corners, thinned_m=by_m, radius_m=radius_m)


def circle_round_m(shape: Polygon, by_m: float) -> float | None:
    """Radius of the circle about a polygon's middle that holds it, where it was drawn for one."""
    middle, edge = shape.centroid, shape.exterior
    away = shapely.get_coordinates(edge) - (middle.x, middle.y)
    # Places on the wire are rounded to centimetres.
    radius_m = 1.0001 * float(np.hypot(*away.T).max()) + 0.05
    nearest_m = float(edge.distance(middle))
    drawn_for_one = len(away) > ROUND_CORNERS and radius_m - nearest_m <= ROUND_PART * radius_m + 0.1
    return radius_m if shape.contains(middle) and drawn_for_one and radius_m - nearest_m <= by_m else None


def thinned(shape: Polygon, by_m: float, *, inside: bool) -> Polygon | None:
    """A polygon of fewer corners round a shape, or in it, everywhere within a distance of its edge.

    The edge is moved to the safe side, notches that are narrow then are closed, and it is straightened by
    less than it was moved. None where that leaves no single polygon.
    """
    moved_m = by_m / 3.0
    away_m = (by_m - moved_m) * (-1.0 if inside else 1.0)
    back_m = moved_m * (1.0 if inside else -1.0)
    found = shape.buffer(away_m).buffer(back_m, quad_segs=64).simplify(0.98 * moved_m)
    if not isinstance(found, Polygon) or found.is_empty or not found.is_valid:
        return None
    found = Polygon(found.exterior)
    safe = shape.covers(found) if inside else found.covers(shape)
    return found if safe else None


def _without_far(
    pieces: list[Piece], flown: BaseGeometry, store: FenceStore
) -> tuple[list[Piece], list[str]]:
    """Without the farthest zones, as few as let the rest fit."""
    if _fits(pieces, store) or flown.is_empty:
        return pieces, []
    away_m = [math.inf if piece.inside else float(flown.distance(piece.shape)) for piece in pieces]
    far = sorted(
        (k for k in range(len(pieces)) if not pieces[k].inside and away_m[k] > FAR_M),
        key=lambda k: -away_m[k],
    )
    gone: set[int] = set()
    for k in far:
        if _fits((piece for j, piece in enumerate(pieces) if j not in gone), store):
            break
        gone.add(k)
    if not gone:
        return pieces, []
    nearest_m = min(away_m[k] for k in gone)
    names = [pieces[k].name for k in sorted(gone)]
    said = (
        f"fence: {_named(names)} {nearest_m / 1000.0:.1f} km or more from the flight: left out, for it to fit"
    )
    return [piece for k, piece in enumerate(pieces) if k not in gone], [said]


def _thinned_notes(pieces: Sequence[Piece], store: FenceStore) -> list[str]:
    changed = [piece.name for piece in pieces if piece.thinned_m > 0.0]
    if not changed:
        return []
    by_m = max(piece.thinned_m for piece in pieces)
    return [
        f"fence: corners of {', '.join(changed[:5])}{' …' if len(changed) > 5 else ''} thinned to fit, "
        f"{store.told}: no edge more than {by_m:g} m from the drawn one, on the safe side"
    ]


def _named(names: list[str]) -> str:
    """The names of zones with the verb that goes with them."""
    if len(names) == 1:
        return f"zone {names[0]!r} lies"
    shown = ", ".join(repr(name) for name in names[:3])
    return f"{len(names)} zones ({shown}{', …' if len(names) > 3 else ''}) lie"
