"""Image quality: the planner's own figures beside those of other geometry.

Parts, each with rows of its own:

``gsd``
    Every camera of the database: height for 2 cm, and ground sampled distance there by equation 2 and by the
    distance between two rays of neighbouring pixels.
``niirs``
    GIQE 4 at both branches of the edge response, and its inverse.
``view``
    Images tilted at random over flat ground: the farthest that corners of the planner's loop are from rays
    cast by turning matrices, metres.
``photos``
    Surveys of random regions at random wishes: what was asked for, the judge's figures, violations.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.sensors.cameras import CAMERAS
from planner.sensors.optics import Optics
from planner.sensors.photo_band import band
from planner.sensors.quality import Giqe4

PARTS = ("gsd", "niirs", "view", "photos")


def run(parts: Sequence[str] = PARTS, seed: int = 1, surveys: int = 4) -> Iterator[dict[str, Any]]:
    """Rows of the parts asked for."""
    asked: dict[str, Callable[[], Iterator[dict[str, Any]]]] = {
        "gsd": _gsd,
        "niirs": _niirs,
        "view": lambda: _view(seed),
        "photos": lambda: _photos(seed, surveys),
    }
    for part in (parts,) if isinstance(parts, str) else parts:
        yield from asked[part]()


def _gsd() -> Iterator[dict[str, Any]]:
    for camera in CAMERAS.values():
        optics = camera.optics
        height_m = optics.height_for_m(0.02)
        # Of the middle pixel and its neighbour, rays through the lens.
        rays_m = [height_m * k * optics.pixel_pitch_m / optics.focal_length_m for k in (0, 1)]
        yield {
            "part": "gsd", "camera": camera.name, "height_m": height_m, "gsd_m": optics.gsd_m(height_m),
            "by_rays_m": rays_m[1] - rays_m[0],
        }  # fmt: skip


def _niirs() -> Iterator[dict[str, Any]]:
    for spectrum in ("visible", "infrared"):
        for rer in (0.8, 0.9, 1.0):
            quality = Giqe4(spectrum, rer, 50.0)
            for gsd_m in (0.01, 0.05, 0.25):
                niirs = quality.niirs(gsd_m)
                yield {
                    "part": "niirs", "spectrum": spectrum, "rer": rer, "gsd_m": gsd_m, "niirs": niirs,
                    "back_m": quality.largest_gsd_m(niirs),
                }  # fmt: skip


def _view(seed: int) -> Iterator[dict[str, Any]]:
    rng = np.random.default_rng(seed)
    worst_m = 0.0
    count = 1000
    for _ in range(count):
        optics = Optics(rng.uniform(0.005, 0.05), rng.uniform(2e-6, 8e-6), 6000, 4000)
        most = math.radians(75.0) - optics.half_height_rad
        tilt, turn, height_m = rng.uniform(-most, most), rng.uniform(-0.6, 0.6), rng.uniform(20.0, 500.0)
        cos, sin = math.cos(tilt), math.sin(tilt)
        pitch = np.array([[cos, 0.0, -sin], [0.0, 1.0, 0.0], [sin, 0.0, cos]])
        yaw = np.array(
            [[math.cos(turn), -math.sin(turn), 0.0], [math.sin(turn), math.cos(turn), 0.0], [0.0, 0.0, 1.0]]
        )
        wide, high = math.tan(optics.half_width_rad), math.tan(optics.half_height_rad)
        rays = np.array(
            [[s, w, -1.0] for s, w in ((-high, -wide), (-high, wide), (high, wide), (high, -wide))]
        )
        turned = rays @ pitch.T @ yaw.T
        cast_m = height_m * turned[:, :2] / -turned[:, 2:]
        ours_m = height_m * np.array(band(optics, tilt, turn).corners)
        worst_m = max(worst_m, float(np.hypot(*(ours_m - cast_m).T).max()))
    yield {"part": "view", "images": count, "farthest_m": worst_m}


def _photos(seed: int, surveys: int) -> Iterator[dict[str, Any]]:
    rng = np.random.default_rng(seed)
    for number in range(surveys):
        gsd_m, wind_m_s = float(rng.uniform(0.02, 0.05)), float(rng.uniform(0.0, 12.0))
        plan = make_plan(read_scenario(_document(rng, gsd_m, wind_m_s)))
        survey = plan.metrics.surveys["field"]
        yield {
            "part": "photos", "survey": number, "wind_m_s": wind_m_s, "asked_gsd_m": gsd_m,
            "gsd_m": survey.gsd_m, "niirs": survey.niirs, "forward_overlap": survey.forward_overlap,
            "side_overlap": survey.side_overlap, "photos_least": survey.photos_least,
            "photos": plan.metrics.photos, "violations": len(plan.violations),
        }  # fmt: skip


def _document(rng: np.random.Generator, gsd_m: float, wind_m_s: float) -> dict[str, Any]:
    turns = np.linspace(0.0, math.tau, 7)[:-1] + rng.uniform(0.0, 0.8, 6)
    parts = rng.uniform(0.7, 1.0, 6)
    ring = [[0.004 * math.cos(a) * s, 0.003 * math.sin(a) * s] for a, s in zip(turns, parts, strict=True)]
    field = {"type": "Polygon", "coordinates": [[*ring, ring[0]]]}
    return {
        "type": "FeatureCollection",
        "features": [
            {
                "type": "Feature", "id": "field", "properties": {"role": "roi", "gsd_m": gsd_m},
                "geometry": field,
            },
            {
                "type": "Feature", "id": "start", "properties": {"role": "start"},
                "geometry": {"type": "Point", "coordinates": [-0.01, 0.0]},
            },
        ],
        "vehicles": [{"name": "wing", "airspeed_m_s": 20.0, "min_turn_radius_m": 60.0}],
        "sensors": [
            {
                "name": "eye", "type": "camera", "model": "Sony RX0", "rer": 0.9, "snr": 50.0,
                "min_interval_s": 0.2,
            }
        ],
        "max_height_m": 400.0,
        "wind": {"speed_m_s": wind_m_s, "from_deg": float(rng.uniform(0.0, 360.0))},
    }  # fmt: skip
