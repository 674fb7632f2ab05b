"""JSON read strictly and written exactly: no NaN, no infinities, no lone surrogates, no repeated names."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Mapping
from typing import Any, NoReturn

from app.services.errors import RefusedError
from planner.errors import Finding

MAX_DEPTH = 64


def _refuse(rule: str, message: str, fix: str) -> NoReturn:
    raise RefusedError(message, (Finding("document", rule, message, fix),))


def _constant(name: str) -> NoReturn:
    _refuse("not-a-number", f"the document holds {name}, which is no JSON number", "write a finite number")


def _float(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        _refuse("not-a-number", f"the number {text[:40]} is too large", "write a finite number")
    return value


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) != len(pairs):
        twice = next(name for name, count in Counter(name for name, _ in pairs).items() if count > 1)
        _refuse("name-repeated", f"an object names {twice[:80]} twice", "name each member once")
    return found


def _no_json(text: str, error: json.JSONDecodeError) -> tuple[str, str]:
    """What a text is that is no JSON, and the way out."""
    if not text.strip():
        return "the document is empty", "send a GeoJSON FeatureCollection"
    if text.lstrip().startswith("<"):
        return (
            "the document is no JSON but looks like XML, as KML and GPX are",
            "turn it into regions first: swathplan import, or POST /api/v1/scenarios/import",
        )
    if text.startswith("QGC WPL"):
        return "the document is a waypoint file, not JSON", "plan from a scenario; convert reads missions"
    place = f"line {error.lineno}, column {error.colno}"
    return (
        f"the document is no JSON: {error.msg} at {place}",
        f"mend it near {place}; one JSON object is meant",
    )


def read_json(body: bytes | str) -> Any:
    """Parse JSON strictly.

    Raises
    ------
    RefusedError
        Rules ``json-syntax``, ``json-encoding``, ``json-depth``, ``not-a-number``, ``name-repeated``.
    """
    try:
        text = body.decode("utf-8-sig") if isinstance(body, bytes) else body
        document = json.loads(text, parse_constant=_constant, parse_float=_float, object_pairs_hook=_object)
        if "\\ud" in text.lower():
            json.dumps(document, ensure_ascii=False).encode()
    except (UnicodeDecodeError, UnicodeEncodeError) as error:
        fix = "send UTF-8 text; KMZ, shapefiles and rasters go in by import, not as a scenario"
        _refuse("json-encoding", f"the document is no UTF-8 text: {error.reason}", fix)
    except json.JSONDecodeError as error:
        _refuse("json-syntax", *_no_json(text, error))
    except RecursionError:
        _refuse("json-depth", "the document is nested too deeply", f"nest at most {MAX_DEPTH} levels")
    except ValueError:
        # CPython refuses to convert integers of more than 4300 digits
        _refuse("not-a-number", "the document holds an integer with thousands of digits", "write a number")
    if _depth(document) > MAX_DEPTH:
        _refuse("json-depth", "the document is nested too deeply", f"nest at most {MAX_DEPTH} levels")
    return document


def read_object(body: bytes | str) -> dict[str, Any]:
    """Parse JSON strictly; the document must be one object (rule ``not-an-object``)."""
    document = read_json(body)
    if not isinstance(document, dict):
        _refuse("not-an-object", "the document is no JSON object", "send a GeoJSON FeatureCollection")
    return document


def _depth(document: Any) -> int:
    deepest, level = 0, [document]
    while level and deepest <= MAX_DEPTH:
        deepest += 1
        level = [
            child
            for item in level
            if isinstance(item, (dict, list))
            for child in (item.values() if isinstance(item, dict) else item)
            if isinstance(child, (dict, list))
        ]
    return deepest


def write_json(document: Mapping[str, Any], indent: int | None = None) -> str:
    """Write JSON; raises ValueError on NaN, which no JSON reader takes."""
    separators = (",", ":") if indent is None else None
    return json.dumps(document, ensure_ascii=False, allow_nan=False, indent=indent, separators=separators)


def name_of(scenario: Mapping[str, Any]) -> str:
    """What a scenario is called."""
    name = scenario.get("name")
    return name[:200] if isinstance(name, str) and name else "scenario"
