"""Random scenarios of several aircraft: who they are, where from, what there is to see and when."""

from __future__ import annotations

from typing import Any

import numpy as np

Document = dict[str, Any]

#: Degrees of half the side of the area, about 2.8 km, and of a region's side.
HALF_DEG, SIDE_DEG = 0.025, (0.001, 0.003)
KINDS = (
    {"type": "fixed_wing", "airspeed_m_s": (16.0, 26.0), "min_turn_radius_m": 70.0},
    {"type": "multirotor", "airspeed_m_s": (9.0, 14.0)},
    {"type": "vtol", "airspeed_m_s": (15.0, 22.0), "min_turn_radius_m": 60.0},
)
SENSOR = {
    "name": "sar", "type": "sar", "incidence_deg": 45.0, "elevation_beamwidth_deg": 30.0,
    "azimuth_beamwidth_deg": 10.0, "look": "both",
}  # fmt: skip


def fleet_scenario(seed: int, band: bool = False) -> Document:
    """Two to four aircraft, from one base or two; six to twelve regions, in a third of all with windows.

    With a band the planner chooses the heights, up to those that are flown without one and down to half.
    """
    rng = np.random.default_rng(seed)
    aircraft = int(rng.integers(2, 5))
    bases = [f"base {k}" for k in range(1 + int(rng.random() < 0.3))]
    alike = KINDS[int(rng.integers(len(KINDS)))] if rng.random() < 0.6 else None
    vehicles = [_vehicle(rng, k, str(rng.choice(bases)), alike) for k in range(aircraft)]
    windows = rng.random() < 0.3
    features = [_feature(name, "base", "Point", _place(rng, 0.5)) for name in bases]
    for k in range(int(rng.integers(6, 13))):
        east, north = _place(rng, 0.9)
        side = float(rng.uniform(*SIDE_DEG))
        ring = [[east, north], [east + side, north], [east + side, north + side], [east, north + side]]
        wishes: Document = {}
        if windows and rng.random() < 0.25:
            opens_s = float(rng.uniform(200.0, 900.0))
            wishes["time_window_s"] = [round(opens_s, 1), round(opens_s + rng.uniform(400.0, 900.0), 1)]
            wishes["required"] = False
        features.append(_feature(f"R{k}", "roi", "Polygon", [[*ring, ring[0]]], **wishes))
    document: Document = {
        "type": "FeatureCollection",
        "name": f"fleet {seed}",
        "features": features,
        "vehicles": vehicles,
        "sensors": [SENSOR],
        "altitude_m": float(rng.choice([250.0, 400.0])),
        "separation": {
            "horizontal_m": float(rng.choice([50.0, 100.0, 200.0])),
            "vertical_m": float(rng.choice([20.0, 30.0, 60.0])),
        },
        "seed": seed,
    }
    if band:
        most_m = document.pop("altitude_m")
        document |= {"max_height_m": most_m, "min_height_m": most_m / 2.0}
    if rng.random() < 0.4:
        document["wind"] = {
            "speed_m_s": round(float(rng.uniform(1.0, 5.0)), 1),
            "from_deg": round(float(rng.uniform(0.0, 359.0)), 1),
        }
    return document


def _vehicle(rng: np.random.Generator, number: int, base: str, alike: Document | None) -> Document:
    kind: Document = dict(alike or KINDS[int(rng.integers(len(KINDS)))])
    speed_m_s = round(float(rng.uniform(*kind["airspeed_m_s"])), 1)
    own = kind | {"name": f"uav {number}", "airspeed_m_s": speed_m_s, "base": base}
    if rng.random() < 0.3:
        own |= {"batteries": 2, "turnaround_s": 120.0, "max_flight_time_s": 2400.0}
    return own


def _place(rng: np.random.Generator, part: float) -> list[float]:
    return [round(float(value), 6) for value in rng.uniform(-part * HALF_DEG, part * HALF_DEG, 2)]


def _feature(name: str, role: str, kind: str, coordinates: Any, **wishes: Any) -> Document:
    return {
        "type": "Feature",
        "id": name,
        "properties": {"role": role, **wishes},
        "geometry": {"type": kind, "coordinates": coordinates},
    }
