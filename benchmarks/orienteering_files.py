"""Files of orienteering problems: OPLib on TSPLIB's distances, and polygons with targets as JSON."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.files import FileError

Floats = NDArray[np.float64]
Ring = tuple[tuple[float, float], ...]

#: As TSPLIB's documentation writes them.
TSPLIB_PI = 3.141592
TSPLIB_EARTH_KM = 6378.388


@dataclass(frozen=True, slots=True)
class OplibProblem:
    """Places with scores, a closed route from the depot within a limit.

    Parameters
    ----------
    distances
        Shape (N, N), rounded as TSPLIB does.
    scores
        Shape (N,).
    limit
        Of the route.
    depot
        Index of the place it starts from and ends at.
    points
        Shape (N, 2), where the file has some.
    published
        Best known score, where there is a file ``.sol`` beside it.
    """

    distances: Floats
    scores: Floats
    limit: float
    depot: int
    points: Floats | None
    published: float | None


@dataclass(frozen=True, slots=True)
class Published:
    """Reward that others reached: ``dubins`` or ``straight``, turn radius, budget, best, mean and seconds."""

    model: str
    turn_radius: float
    budget: float
    best: float
    mean: float | None
    seconds: float | None


@dataclass(frozen=True, slots=True)
class PolygonProblem:
    """Targets among polygons that may be touched but not entered.

    Parameters
    ----------
    border
        Ring of the map; empty where there is none.
    obstacles
        Rings.
    start, end
        Ends of the path, any direction there.
    targets, rewards
        Shape (N, 2) and (N,).
    """

    border: Ring
    obstacles: tuple[Ring, ...]
    start: tuple[float, float]
    end: tuple[float, float]
    targets: Floats
    rewards: Floats
    published: tuple[Published, ...]


def read(path: Path) -> OplibProblem | PolygonProblem:
    """Read a file of either kind.

    Raises
    ------
    FileError
        With the name of what is missing.
    """
    try:
        text = path.read_text(encoding="utf-8")
        if text.lstrip().startswith("{"):
            return _polygons(json.loads(text))
        return _oplib(text, _solution(path.with_suffix(".sol")))
    except (KeyError, IndexError, TypeError, ValueError) as error:
        raise FileError(f"{path.name}: no orienteering problem: {error!r}") from error


def _polygons(sheet: dict[str, Any]) -> PolygonProblem:
    targets = sheet["targets"]
    published = tuple(
        Published(
            str(row["model"]), float(row["turn_radius"]), float(row["budget"]), float(row["reward_best"]),
            row.get("reward_mean"), row.get("seconds_mean"),
        )
        for row in sheet.get("published", ())
    )  # fmt: skip
    return PolygonProblem(
        _ring(sheet.get("border") or ()),
        tuple(_ring(ring) for ring in sheet["obstacles"]),
        _place(sheet["start"]),
        _place(sheet["end"]),
        np.array([target["at"] for target in targets], dtype=np.float64).reshape(-1, 2),
        np.array([target["reward"] for target in targets], dtype=np.float64),
        published,
    )


def _place(pair: Any) -> tuple[float, float]:
    return float(pair[0]), float(pair[1])


def _ring(pairs: Any) -> Ring:
    ring = tuple(_place(pair) for pair in pairs)
    return ring[:-1] if len(ring) > 1 and ring[0] == ring[-1] else ring


def _solution(path: Path) -> float | None:
    if not path.exists():
        return None
    for line in path.read_text(encoding="utf-8").splitlines():
        key, colon, value = line.partition(":")
        if colon and key.strip() == "ROUTE_SCORE":
            return float(value)
    return None


def _oplib(text: str, published: float | None) -> OplibProblem:
    head: dict[str, str] = {}
    sections: dict[str, list[str]] = {}
    section: list[str] | None = None
    for line in text.splitlines():
        words = line.split()
        if not words or words[0] == "EOF":
            continue
        key, colon, value = line.partition(":")
        if words[0].endswith("_SECTION"):
            section = sections.setdefault(words[0], words[1:])
        elif colon and key.strip().isupper() and not key.strip()[0].isdigit():
            head[key.strip()] = value.strip()
            section = None
        elif section is not None:
            section.extend(words)
        else:
            raise FileError(f"unknown line {line!r}")
    count = int(head["DIMENSION"])
    scores = np.zeros(count)
    for name, score in _rows(sections["NODE_SCORE_SECTION"], 2):
        scores[int(name) - 1] = float(score)
    points = None
    if "NODE_COORD_SECTION" in sections:
        points = np.empty((count, 2))
        for name, x, y in _rows(sections["NODE_COORD_SECTION"], 3):
            points[int(name) - 1] = float(x), float(y)
    kind = head["EDGE_WEIGHT_TYPE"]
    if kind == "EXPLICIT":
        distances = _explicit(head["EDGE_WEIGHT_FORMAT"], sections["EDGE_WEIGHT_SECTION"], count)
    elif points is None:
        raise FileError("NODE_COORD_SECTION is missing")
    else:
        distances = _distances(kind, points)
    depot = int(sections.get("DEPOT_SECTION", ["1"])[0]) - 1
    return OplibProblem(distances, scores, float(head["COST_LIMIT"]), depot, points, published)


def _rows(words: list[str], width: int) -> Iterator[tuple[str, ...]]:
    return itertools.zip_longest(*(iter(words),) * width, fillvalue="")


def _distances(kind: str, points: Floats) -> Floats:
    """TSPLIB 95 (G. Reinelt), section 2."""
    if kind == "GEO":
        return _geographic(points)
    away = np.abs(points[:, None] - points[None])
    if kind == "MAN_2D":
        return np.asarray(np.floor(away.sum(axis=2) + 0.5))
    if kind == "MAX_2D":
        return np.asarray(np.floor(away + 0.5).max(axis=2))
    straight = np.sqrt((away**2).sum(axis=2))
    if kind == "EUC_2D":
        return np.asarray(np.floor(straight + 0.5))
    if kind == "CEIL_2D":
        return np.asarray(np.ceil(straight))
    if kind == "ATT":
        tenth = np.sqrt((away**2).sum(axis=2) / 10.0)
        rounded = np.floor(tenth + 0.5)
        return np.asarray(np.where(rounded < tenth, rounded + 1.0, rounded))
    raise FileError(f"unknown EDGE_WEIGHT_TYPE {kind}")


def _geographic(points: Floats) -> Floats:
    degrees = np.trunc(points)
    radians = TSPLIB_PI * (degrees + 5.0 * (points - degrees) / 3.0) / 180.0
    latitude, longitude = radians[:, 0], radians[:, 1]
    q1 = np.cos(longitude[:, None] - longitude[None])
    q2 = np.cos(latitude[:, None] - latitude[None])
    q3 = np.cos(latitude[:, None] + latitude[None])
    cosine = np.clip(0.5 * ((1.0 + q1) * q2 - (1.0 - q1) * q3), -1.0, 1.0)
    distances = np.floor(TSPLIB_EARTH_KM * np.arccos(cosine) + 1.0)
    np.fill_diagonal(distances, 0.0)
    return np.asarray(distances)


def _explicit(form: str, words: list[str], count: int) -> Floats:
    values = np.array(words, dtype=np.float64)
    if form == "FULL_MATRIX":
        return values.reshape(count, count)
    # Columns of one triangle are rows of the other.
    upper = form in ("UPPER_ROW", "UPPER_DIAG_ROW", "LOWER_COL", "LOWER_DIAG_COL")
    if not upper and form not in ("LOWER_ROW", "LOWER_DIAG_ROW", "UPPER_COL", "UPPER_DIAG_COL"):
        raise FileError(f"unknown EDGE_WEIGHT_FORMAT {form}")
    offset = 0 if "DIAG" in form else 1
    rows, columns = np.triu_indices(count, offset) if upper else np.tril_indices(count, -offset)
    distances = np.zeros((count, count))
    distances[rows, columns] = values
    distances[columns, rows] = values
    return distances


def budget_name(budget: float) -> str:
    """As files are named after it: without a fraction where it has none."""
    return str(int(budget)) if math.isfinite(budget) and budget == int(budget) else repr(budget)
