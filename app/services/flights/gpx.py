"""A flown track as GPX 1.1, for programs that know no GeoJSON."""

from __future__ import annotations

import math
from datetime import UTC, datetime, timedelta
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from app.services.records import FlightRecord, TrackSample
from app.version import VERSION

_NAMESPACE = "http://www.topografix.com/GPX/1/1"


def write_gpx(record: FlightRecord, samples: tuple[TrackSample, ...]) -> str:
    """The track of one flight: places, heights over the sea where they are known, and times.

    The times count from the flight's start by the service's clock, spaced as the vehicle's own clock says.
    """
    root = Element("gpx", {"version": "1.1", "creator": f"Swathplan {VERSION}", "xmlns": _NAMESPACE})
    metadata = SubElement(root, "metadata")
    SubElement(metadata, "time").text = _time(record.started_at, 0.0)
    track = SubElement(root, "trk")
    SubElement(track, "name").text = _text(record.vehicle_name)
    SubElement(track, "desc").text = _text(f"flight {record.id}")
    segment = SubElement(track, "trkseg")
    for sample in samples:
        place = {"lat": f"{sample.lat_deg:.7f}", "lon": f"{sample.lon_deg:.7f}"}
        point = SubElement(segment, "trkpt", place)
        if sample.altitude_amsl_m is not None and math.isfinite(sample.altitude_amsl_m):
            SubElement(point, "ele").text = f"{sample.altitude_amsl_m:.2f}"
        SubElement(point, "time").text = _time(record.started_at, sample.time_s - samples[0].time_s)
    indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(root, encoding="unicode") + "\n"


def _time(started_at: datetime, after_s: float) -> str:
    start = started_at if started_at.tzinfo is not None else started_at.replace(tzinfo=UTC)
    moment = start.astimezone(UTC) + timedelta(seconds=after_s)
    return moment.isoformat(timespec="milliseconds").replace("+00:00", "Z")


def _text(text: str) -> str:
    """Text without the characters that XML 1.0 cannot hold."""
    return "".join(c for c in text if c in "\t\n\r" or 0x20 <= ord(c) <= 0xD7FF or 0xE000 <= ord(c) != 0xFFFE)
