"""Members of a JSON document, each looked at before it is used and named where it is wrong."""

from __future__ import annotations

import math
from typing import Any, Final

from mavlink.formats.errors import FormatError
from mavlink.formats.places import lat_lon_problem
from mavlink.wire.items import degrees_e7

#: What a number of 32 bits holds at most.
LARGEST: Final = 3.4028234e38


def place_of(lat_deg: float, lon_deg: float, name: str) -> tuple[float, float]:
    """Longitude and latitude as the wire holds them."""
    problem = lat_lon_problem(lat_deg, lon_deg)
    if problem:
        raise FormatError(f"{name}: {problem}; {lat_deg}, {lon_deg} is nowhere on Earth")
    return degrees_e7(lon_deg) / 1e7, degrees_e7(lat_deg) / 1e7


def check_version(value: dict[str, Any], wanted: int, name: str) -> None:
    """Refuse another version than the wanted."""
    if value.get("version") != wanted:
        raise FormatError(f"{name} is {value.get('version')!r}, {wanted} is meant")


def object_of(value: Any, name: str) -> dict[str, Any]:
    """A JSON object."""
    if not isinstance(value, dict):
        raise FormatError(f"{name} is no object")
    return value


def list_of(value: Any, name: str) -> list[Any]:
    """A JSON list."""
    if not isinstance(value, list):
        raise FormatError(f"{name} is no list")
    return value


def number_of(value: Any, name: str) -> float:
    """A number; null is NaN."""
    if value is None:
        return math.nan
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise FormatError(f"{name} is {value!r}, a number is meant")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if abs(number) > LARGEST:
        raise FormatError(f"{name} is too large: vehicles hold numbers up to {LARGEST:.2g}")
    return number


def integer_of(value: Any, name: str) -> int:
    """A whole number."""
    number = number_of(value, name)
    if not (math.isfinite(number) and number == round(number)):
        raise FormatError(f"{name} is {value!r}, a whole number is meant")
    return round(number)


def numbers_of(value: Any, count: int, name: str) -> list[float]:
    """A list of so many numbers, null being NaN."""
    numbers = [number_of(entry, name) for entry in list_of(value, name)]
    if len(numbers) != count:
        raise FormatError(f"{name} has {len(numbers)} numbers, {count} are meant")
    return numbers


def boolean_of(value: Any, name: str) -> bool:
    """True or false."""
    if not isinstance(value, bool):
        raise FormatError(f"{name} is {value!r}, true or false is meant")
    return value
