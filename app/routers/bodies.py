"""The scenario as OpenAPI tells it: its outline and an example that plans."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from planner.geojson.equipment import METHODS
from planner.geojson.features import LOWEST_M
from planner.geojson.fields import MOST
from planner.geojson.going_on import MOST_S as LATEST_S
from planner.geojson.scenario_reader import MOST_SEED
from planner.geojson.searching import LEAST_SPREAD_M, MOST_ELAPSED_S, MOST_SCORE, MOST_SPREAD_M
from planner.wishes import HIGHEST_M, GoingOn

EXAMPLE: dict[str, Any] = json.loads(
    (Path(__file__).resolve().parents[1] / "examples" / "scenario.geojson").read_text(encoding="utf-8")
)

HEIGHT_M = {"type": "number", "minimum": LOWEST_M, "maximum": HIGHEST_M}

SCENARIO_SCHEMA: dict[str, Any] = {
    "title": "Scenario",
    "description": "A GeoJSON FeatureCollection (RFC 7946); each feature says its part by `properties.role`. "
    "Vehicles, sensors and wishes are foreign members of the collection.",
    "type": "object",
    "required": ["type", "features", "vehicles", "sensors"],
    "properties": {
        "type": {"const": "FeatureCollection"},
        "name": {"type": "string"},
        "features": {
            "type": "array",
            "items": {
                "type": "object",
                "required": ["type", "geometry", "properties"],
                "properties": {
                    "type": {"const": "Feature"},
                    "id": {"type": ["string", "integer"]},
                    "geometry": {"type": "object", "required": ["type", "coordinates"]},
                    "properties": {
                        "type": "object",
                        "required": ["role"],
                        "properties": {
                            "role": {
                                "enum": [
                                    "roi",
                                    "threat",
                                    "no_fly",
                                    "obstacle",
                                    "area",
                                    "start",
                                    "end",
                                    "base",
                                    "importance",
                                ]
                            },
                            "name": {"type": "string"},
                            "score": {
                                "type": "number",
                                "minimum": 0,
                                "maximum": MOST_SCORE,
                                "description": "Of importance: what seeing a square metre is worth; of a "
                                "Point, at the point.",
                            },
                            "spread_m": {
                                "type": "number",
                                "minimum": LEAST_SPREAD_M,
                                "maximum": MOST_SPREAD_M,
                                "description": "Of importance that is a Point: standard deviation, in each "
                                "direction, of the normal distribution that its score falls off by.",
                            },
                        },
                    },
                },
            },
        },
        "vehicles": {
            "type": "array",
            "items": {"type": "object"},
            "minItems": 1,
            "description": "Of several each has a name of its own, and may have sensors (those on board), a "
            "base, end_bases of which it lands at one, and batteries with turnaround_s between flights. Work "
            "whose mission has more items than the autopilot holds (max_items, ArduPlane 655, "
            "ArduCopter 650, PX4 500) is flown in several.",
        },
        "separation": {
            "type": "object",
            "description": "What several vehicles keep from each other at every instant: one of the two.",
            "properties": {
                "horizontal_m": {"type": "number", "minimum": 0, "maximum": MOST, "default": 100},
                "vertical_m": {"type": "number", "minimum": 0, "maximum": MOST, "default": 30},
            },
        },
        "replan": {
            "type": "object",
            "description": "Of what is left of a plan being flown; POST /plans/{id}/replan writes it.",
            "properties": {
                "begins_in_s": {
                    "type": "number",
                    "minimum": 0,
                    "maximum": LATEST_S,
                    "default": 0,
                    "description": "From the call to the plan's beginning, when in_flight is true.",
                },
                "order": {
                    "type": "object",
                    "additionalProperties": {"type": "array", "items": {"type": "string"}},
                    "description": "By vehicle, the regions that it was to see, in flight order: it stays.",
                },
                "unless_better": {
                    "type": "number",
                    "minimum": 0,
                    "maximum": 1,
                    "default": GoingOn().unless_better,
                    "description": "Another order is flown where it is better by this part.",
                },
            },
        },
        "sensors": {"type": "array", "items": {"type": "object"}, "minItems": 1},
        "altitude_m": {
            "type": "number",
            "minimum": LOWEST_M,
            "maximum": HIGHEST_M,
            "description": "Absent: the planner chooses heights by gsd_m, min_resolution_m or min_niirs of "
            "the regions, or up to max_height_m.",
        },
        "min_height_m": {
            **HEIGHT_M,
            "description": "Over ground, of heights that are chosen, and of legs on which aircraft cross.",
        },
        "max_height_m": {**HEIGHT_M, "description": "Over ground: no pass is higher."},
        "altitude_reference": {"enum": ["amsl", "home", "terrain"], "default": "terrain"},
        "terrain": {"type": "string", "description": "Id of an uploaded elevation raster."},
        "terrain_following": {"type": "boolean", "default": False},
        "task": {
            "enum": ["collect", "search"],
            "default": "collect",
            "description": "See every region; or search: see as much ground, or as much importance, as the "
            "vehicle's energy, range and time allow, and end at the end.",
        },
        "importance_raster": {
            "type": "string",
            "description": "Of a search: id of an uploaded raster with the worth of seeing a square metre.",
        },
        "search": {
            "type": "object",
            "description": "How a search finds what it looks for.",
            "properties": {
                "detection": {
                    "type": "number",
                    "exclusiveMinimum": 0,
                    "maximum": 1,
                    "default": 1,
                    "description": "Probability that a look (a pass over it) finds what is there: k looks "
                    "collect 1 - (1 - detection)^k of what ground is worth.",
                },
                "seen": {
                    "type": "array",
                    "description": "Ground looked at before the search's start, a look an entry: a "
                    "Polygon, a MultiPolygon, or a Feature of one with properties ago_s [begin, end], "
                    "seconds before the start [0, 0], and heading_deg, the direction flown over it, which "
                    "matter where what is looked for drifts.",
                    "items": {"type": "object"},
                },
                "drift": {
                    "type": "object",
                    "description": "How what is looked for moves from where importance says.",
                    "required": ["speed_m_s", "toward_deg"],
                    "properties": {
                        "speed_m_s": {"type": "number", "minimum": 0, "maximum": 20},
                        "toward_deg": {"type": "number", "minimum": 0, "maximum": 360},
                        "spread_m_s": {
                            "type": "number",
                            "minimum": 0,
                            "maximum": 20,
                            "default": 0,
                            "description": "Standard deviation in each direction.",
                        },
                        "elapsed_s": {
                            "type": "number",
                            "minimum": 0,
                            "maximum": MOST_ELAPSED_S,
                            "default": 0,
                            "description": "How long before the search's start it was there.",
                        },
                    },
                },
            },
        },
        "wind": {"type": "object"},
        "clearance_m": {
            "type": "number",
            "minimum": 0,
            "maximum": MOST,
            "description": "Kept from everything hard (no_fly, obstacle, hard threats), beside, over and "
            "under it, and over terrain. Absent: what the vehicle's autopilot is flown off its line "
            "(30 m ArduPlane, 20 m PX4's wings, 5 m multirotors), 30 m over terrain. 0 is 0.",
        },
        "objective": {"type": "object"},
        "method": {
            "type": "object",
            "properties": {stage: {"enum": list(names)} for stage, names in METHODS.items()},
        },
        "seed": {"type": "integer", "minimum": 0, "maximum": MOST_SEED},
        "time_budget_s": {"type": "number", "exclusiveMinimum": 0, "maximum": MOST},
    },
}

_MEDIA: dict[str, Any] = {
    "schema": SCENARIO_SCHEMA,
    "examples": {"two-regions": {"summary": "Two regions and a threat", "value": EXAMPLE}},
}

SCENARIO_BODY: dict[str, Any] = {
    "required": True,
    "content": {"application/json": _MEDIA, "application/geo+json": _MEDIA},
}

_DRAFT: dict[str, Any] = {
    "schema": {
        "title": "Draft",
        "description": "A scenario that may be unfinished; it is kept as it is.",
        "type": "object",
    }
}

DRAFT_BODY: dict[str, Any] = {
    "required": True,
    "content": {"application/json": _DRAFT, "application/geo+json": _DRAFT},
}

#: Mission files, as other programs write them.
MISSION_BODY: dict[str, Any] = {
    "required": True,
    "content": {
        media_type: {"schema": {"type": "string", "description": "A .plan, .mission or .waypoints file."}}
        for media_type in ("application/octet-stream", "text/plain", "application/json")
    },
}
