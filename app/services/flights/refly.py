"""A new scenario of what a flight did not see; everything else is as it was."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from typing import Any

from app.services.flights.as_flown import Gap
from planner.frames import LocalFrame
from planner.geojson.geometry import written

#: Properties of a region that no longer hold for a part of it.
OF_THE_WHOLE = frozenset({"name", "width_m", "radius_m", "time_window_s", "revisits"})
MOST_GAPS = 50


def refly_scenario(
    document: Mapping[str, Any],
    gaps: Sequence[Gap],
    frame: LocalFrame,
    vehicle: str | None,
    here: tuple[float, float, float | None] | None,
) -> dict[str, Any]:
    """The scenario to post.

    Parameters
    ----------
    document
        The scenario that was flown.
    vehicle
        The one that flew; others are left out.
    here
        Longitude, latitude and course in degrees of the aircraft in flight: the new start, while the end
        stays where it was. None to start where the first flight did.
    """
    made = copy.deepcopy(dict(document))
    made["name"] = f"{document.get('name') or 'flight'}-refly"
    made.pop("task", None)
    features = [feature for feature in made["features"] if feature["properties"]["role"] != "roi"]
    made["features"] = [*_regions(document, gaps, frame), *features]
    vehicles = [each for each in made.get("vehicles", []) if each.get("name") == vehicle]
    if vehicles:
        made["vehicles"] = vehicles
    if here is not None:
        _start_here(made, here)
    return made


def _regions(document: Mapping[str, Any], gaps: Sequence[Gap], frame: LocalFrame) -> list[dict[str, Any]]:
    asked = {_name(f): f["properties"] for f in document["features"] if f["properties"]["role"] == "roi"}
    regions = []
    for number, gap in enumerate(gaps[:MOST_GAPS], start=1):
        properties = {k: v for k, v in asked.get(gap.roi, {}).items() if k not in OF_THE_WHOLE}
        name = f"{gap.roi} gap {number}"
        regions.append(
            {
                "type": "Feature",
                "id": name,
                "geometry": written(gap.area, frame),
                "properties": properties | {"role": "roi"},
            }
        )
    return regions


def _name(feature: Mapping[str, Any]) -> str:
    return str(feature.get("id", feature["properties"].get("name")))


def _start_here(made: dict[str, Any], here: tuple[float, float, float | None]) -> None:
    """Move the start to the aircraft; the end, or where it began, is still where it has to go."""
    lon_deg, lat_deg, course_deg = here
    by_role = {feature["properties"]["role"]: feature for feature in made["features"]}
    start = by_role.get("start")
    if start is None:
        start = {"type": "Feature", "id": "refly-start", "properties": {"role": "start"}}
        start["geometry"] = {"type": "Point", "coordinates": [lon_deg, lat_deg]}
        made["features"].append(start)
    place = start["geometry"]["coordinates"]
    if "end" not in by_role:
        back = {"type": "Point", "coordinates": list(place)}
        made["features"].append(
            {"type": "Feature", "id": "refly-end", "geometry": back, "properties": {"role": "end"}}
        )
    start["geometry"] = {"type": "Point", "coordinates": [lon_deg, lat_deg, *place[2:]]}
    start["properties"].pop("heading_deg", None)
    if course_deg is not None:
        start["properties"]["heading_deg"] = course_deg
    for vehicle in made.get("vehicles", []):
        vehicle.pop("base", None)
