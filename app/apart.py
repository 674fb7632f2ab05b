"""The links' own process, as the settings of a service want it."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict

from app.services.links.keeper import Keeper
from app.services.links.place import place_of
from app.services.vehicles.greeting import Wishes
from app.settings import Settings
from app.version import VERSION

#: Settings that only the service itself takes notice of: another value needs no other process.
_OF_THE_SERVICE = {
    "host", "port", "workers", "plan_time_limit_s", "max_queued_plans", "plan_memory_bytes",
    "request_workers", "max_wait_s", "max_terrain_bytes", "max_log_bytes", "static_dir",
}  # fmt: skip


def settings_text(settings: Settings) -> str:
    """Settings for another process, wherever that one works."""
    log_dir = None if settings.log_dir is None else settings.log_dir.resolve()
    keys = None if settings.signing_keys is None else settings.signing_keys.resolve()
    places = {
        "signing_keys": keys,
        "database": settings.database.resolve(),
        "log_dir": log_dir,
        "replay_folders": tuple(folder.resolve() for folder in settings.replay_folders),
    }
    whole = settings.model_copy(update=places)
    return whole.model_dump_json()


def fingerprint_of(settings: Settings) -> str:
    """The same for processes that do the same."""
    known = {
        name: value
        for name, value in json.loads(settings_text(settings)).items()
        if name not in _OF_THE_SERVICE
    }
    return hashlib.sha256(json.dumps([VERSION, known], sort_keys=True).encode()).hexdigest()[:16]


def keeper_of(settings: Settings, wishes: Wishes | None = None, *, keep: bool = False) -> Keeper:
    """Who keeps the process of a service."""
    return Keeper(
        place_of(settings.database),
        settings_text(settings),
        VERSION,
        fingerprint_of(settings),
        keep=keep,
        wishes=None if wishes is None else asdict(wishes),
    )
