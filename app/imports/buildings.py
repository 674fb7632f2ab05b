"""Buildings of maps, by the tags of OpenStreetMap: how high they stand, and from what height on.

``height`` and ``min_height`` are metres unless a unit is told (``12``, ``12 m``, ``40'``, ``40 ft``,
``5'10"``). Without ``height``, ``building:levels`` and ``roof:levels`` count 3 m each, as there. What is
written in another way is not known, and nothing is taken for lower than it may be.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass

from app.imports.shapes import Shape

#: Of one level, metres, where only their number is known.
LEVEL_M = 3.0
#: Higher than anything built: a mistake.
HIGHEST_M = 2_000.0
FOOT_M, INCH_M = 0.3048, 0.0254
_TAGS = ("building", "building:part")
_TOPS = ("height_m", "height", "building:height")
_BASES = ("base_m", "min_height", "building:min_height")
_NO_BUILDING = frozenset(("", "no", "false", "0", "none", "null"))
_METRES = re.compile(r"([0-9]+(?:\.[0-9]+)?)\s*(?:m|metres?|meters?)?")
_FEET = re.compile(
    r"([0-9]+(?:\.[0-9]+)?)\s*(?:ft|feet|foot|')(?:\s*([0-9]+(?:\.[0-9]+)?)\s*(?:in|inch(?:es)?|\"))?"
)
_NUMBER = re.compile(r"[0-9]+(?:\.[0-9]+)?")
#: ``"key"=>"value"``, as GDAL writes the tags that have no column.
_PAIR = re.compile(r'"((?:[^"\\]|\\.)*)"\s*=>\s*"((?:[^"\\]|\\.)*)"')


@dataclass(frozen=True, slots=True)
class Standing:
    """A building: what says so, and how high it stands; None where that is not known.

    Parameters
    ----------
    why
        The tag.
    height_m, base_m
        Over the ground: its top, and what can be passed below it.
    """

    why: str
    height_m: float | None
    base_m: float = 0.0


def standing(shape: Shape) -> Standing | None:
    """The building that a shape is; None where it is none."""
    tags = tags_of(shape.properties)
    key = next((key for key in _TAGS if tags.get(key, "").strip().lower() not in _NO_BUILDING), None)
    if key is None:
        return None
    height_m, base_m = heights(tags)
    return Standing(f"its {key} is {tags[key][:40]!r}", height_m, base_m)


def heights(tags: Mapping[str, str]) -> tuple[float | None, float]:
    """Top, None where it is not known, and base over the ground, 0 where in doubt."""
    top_m = _first(tags, _TOPS)
    if top_m is None and not any(tags.get(key) for key in _TOPS):
        levels = _levels(tags, "building:levels")
        if levels is not None:
            roof = _levels(tags, "roof:levels") or 0.0
            top_m = LEVEL_M * (levels + roof)
    if top_m is None or not 0.0 < top_m <= HIGHEST_M:
        return None, 0.0
    base_m = _first(tags, _BASES)
    if base_m is None and not any(tags.get(key) for key in _BASES):
        levels = _levels(tags, "building:min_level")
        base_m = None if levels is None else LEVEL_M * levels
    if base_m is None or base_m >= top_m:
        return top_m, 0.0
    return top_m, base_m


def metres(text: str) -> float | None:
    """A height in metres; None where it is not plainly one."""
    text = text.strip().lower().replace("′", "'").replace("″", '"').replace("’", "'").replace("”", '"')
    if found := _METRES.fullmatch(text):
        return float(found[1])
    if found := _FEET.fullmatch(text):
        return float(found[1]) * FOOT_M + float(found[2] or 0.0) * INCH_M
    return None


def tags_of(properties: Mapping[str, str]) -> dict[str, str]:
    """Values of a shape, with those kept in one text: ``tags`` as JSON, ``other_tags`` as pairs."""
    tags: dict[str, str] = {}
    nested = properties.get("tags", "")
    if nested.startswith("{"):
        try:
            found = json.loads(nested)
        except ValueError:
            found = {}
        tags |= {str(key).lower(): str(value) for key, value in found.items()}
    tags |= {key.lower(): value for key, value in _PAIR.findall(properties.get("other_tags", ""))}
    return tags | dict(properties)


def _first(tags: Mapping[str, str], keys: tuple[str, ...]) -> float | None:
    text = next((tags[key] for key in keys if tags.get(key)), None)
    return None if text is None else metres(text)


def _levels(tags: Mapping[str, str], key: str) -> float | None:
    text = tags.get(key, "").strip()
    return float(text) if _NUMBER.fullmatch(text) else None
