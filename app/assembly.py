"""An application of routes, with what stands round every one of them: problems, the guard, caps, the log."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from contextlib import AbstractAsyncContextManager
from typing import Any

from fastapi import APIRouter, FastAPI

from app import middleware, problems
from app.services.limits import Limits
from app.services.vehicles.keys import KeyRing
from app.services.vehicles.recordings import Recordings
from app.settings import Settings
from mavlink.links.recording import TlogLimits


def limits_of(settings: Settings) -> Limits:
    """What the services need to know of the settings."""
    return Limits(
        database=settings.database,
        workers=settings.workers,
        plan_time_limit_s=settings.plan_time_limit_s,
        max_queued_plans=settings.max_queued_plans,
        track_interval_s=settings.track_interval_s,
        plan_memory_bytes=settings.plan_memory_bytes,
        request_workers=settings.request_workers,
        request_time_limit_s=settings.request_time_limit_s,
        request_memory_bytes=settings.request_memory_bytes,
        recordings=_recordings_of(settings),
        keys=keys_of(settings),
    )


def keys_of(settings: Settings) -> KeyRing:
    """Where the vehicles' keys are found."""
    return KeyRing(settings.signing_keys, settings.database.parent / "signing", os.environ)


def _recordings_of(settings: Settings) -> Recordings | None:
    if not settings.record_links:
        return None
    total_bytes = settings.log_total_bytes
    limits = TlogLimits(min(settings.log_file_bytes, total_bytes), total_bytes)
    return Recordings(settings.log_dir or settings.database.parent / "logs", limits)


Lifespan = Callable[[FastAPI], AbstractAsyncContextManager[None]]


def assemble(
    settings: Settings, lifespan: Lifespan, routers: Iterable[APIRouter], **described: Any
) -> FastAPI:
    """The application; ``described`` goes to FastAPI, for the interface's description."""
    app = FastAPI(lifespan=lifespan, docs_url=None, redoc_url=None, **described)
    app.state.settings = settings
    problems.install(app)
    for router in routers:
        app.include_router(router)
    # The last added stands outermost.
    app.add_middleware(
        middleware.BodyCap,
        max_bytes=settings.max_body_bytes,
        larger={
            "/api/v1/terrain": settings.max_terrain_bytes,
            "/api/v1/flights/*/log": settings.max_log_bytes,
        },
    )
    app.add_middleware(
        middleware.Guard, allowed_hosts=settings.allowed_hosts, allowed_origins=settings.allowed_origins
    )
    app.add_middleware(middleware.RequestLog)
    return app
