"""A flight's track as GeoJSON."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from app.services.records import FlightEvent, FlightRecord, TrackSample
from planner.geojson.sheet import continued


def feature(geometry: dict[str, Any], **properties: Any) -> dict[str, Any]:
    """One GeoJSON feature."""
    return {"type": "Feature", "geometry": geometry, "properties": properties}


def line_of(samples: Sequence[TrackSample]) -> list[list[float]]:
    """A line's positions; its longitudes go on from the first, beyond ±180° where it crosses there."""
    places = continued([(sample.lon_deg, sample.lat_deg) for sample in samples], samples[0].lon_deg)
    return [
        [lon, lat] if sample.altitude_amsl_m is None else [lon, lat, sample.altitude_amsl_m]
        for (lon, lat), sample in zip(places, samples, strict=True)
    ]


_OF_A_PHOTO = ("time_s", "index", "altitude_home_m", "heading_deg", "roll_deg", "pitch_deg")


def track_geojson(
    record: FlightRecord,
    samples: tuple[TrackSample, ...],
    photos: Sequence[FlightEvent] = (),
    events: Sequence[FlightEvent] = (),
) -> dict[str, Any]:
    """A track as a FeatureCollection: roles ``track``, ``sensor_on`` and ``photo``.

    Beside the line stand the vehicle's times in seconds since boot, the height above home, heading, roll,
    pitch and ground speed, and whether an onboard log told of it, one of each for every vertex. The member
    ``switches`` tells when the sensor, or the output that switches it, was reported on and off; ``actions``
    what the service did by itself.
    """
    features = []
    if len(samples) > 1:
        line = {"type": "LineString", "coordinates": line_of(samples)}
        columns = {
            "times_s": [sample.time_s for sample in samples],
            "altitudes_home_m": [sample.altitude_home_m for sample in samples],
            "headings_deg": [sample.heading_deg for sample in samples],
            "rolls_deg": [sample.roll_deg for sample in samples],
            "pitches_deg": [sample.pitch_deg for sample in samples],
            "ground_speeds_m_s": [sample.ground_speed_m_s for sample in samples],
            "sensor_on": [sample.sensor_on for sample in samples],
            "from_log": [sample.from_log for sample in samples],
        }
        features.append(feature(line, role="track", vehicle=record.vehicle_name, **columns))
    for run in _runs(samples):
        line = {"type": "LineString", "coordinates": line_of(run)}
        times = {"start_s": run[0].time_s, "end_s": run[-1].time_s}
        features.append(feature(line, role="sensor_on", vehicle=record.vehicle_name, **times))
    for photo in photos:
        height = [] if photo.altitude_amsl_m is None else [photo.altitude_amsl_m]
        point = {"type": "Point", "coordinates": [photo.lon_deg, photo.lat_deg, *height]}
        told = {name: getattr(photo, name) for name in _OF_A_PHOTO}
        features.append(feature(point, role="photo", vehicle=record.vehicle_name, **told))
    return {
        "type": "FeatureCollection",
        "flight": record.id,
        "plan": record.plan_id,
        "payload": record.payload,
        "switches": [
            {"time_s": event.time_s, "state": event.kind, "source": event.source, "index": event.index}
            for event in events
            if event.kind != "photo"
        ],
        "actions": [asdict(action) | {"at": action.at.isoformat()} for action in record.actions],
        "features": features,
    }


def _runs(samples: tuple[TrackSample, ...]) -> list[list[TrackSample]]:
    runs: list[list[TrackSample]] = [[]]
    for sample in samples:
        if sample.sensor_on:
            runs[-1].append(sample)
        elif runs[-1]:
            runs.append([])
    return [run for run in runs if len(run) > 1]
