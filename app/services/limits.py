"""How much the services take on."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from app.services.vehicles.keys import KeyRing
from app.services.vehicles.recordings import Recordings


@dataclass(frozen=True, slots=True)
class Limits:
    """How much the services take on."""

    database: Path
    workers: int
    plan_time_limit_s: float
    max_queued_plans: int
    track_interval_s: float
    plan_memory_bytes: int = 8_000_000_000
    request_workers: int = 3
    request_time_limit_s: float = 30.0
    request_memory_bytes: int = 2_000_000_000
    recordings: Recordings | None = None
    keys: KeyRing | None = None
