"""Probes and figures for those who keep the service running."""

from __future__ import annotations

from fastapi import APIRouter, Response
from prometheus_client import CONTENT_TYPE_LATEST, generate_latest

from app.deps import HouseDep
from app.schemas.health import Health
from app.version import VERSION

router = APIRouter(tags=["health"])


@router.get("/health/live", summary="Is the process alive?")
async def live() -> Health:
    """200 as long as the event loop turns."""
    return Health(status="ok", version=VERSION)


@router.get(
    "/health/ready",
    summary="Can it plan?",
    responses={503: {"model": Health, "description": "Workers are still compiling their kernels."}},
)
async def ready(house: HouseDep, response: Response) -> Health:
    """200 once the database answers and a planning process is warm."""
    checks = {
        "database": await house.database.answers(),
        "workers": house.pool.ready and house.desk.pool.ready,
    }
    ready = all(checks.values())
    response.status_code = 200 if ready else 503
    return Health(status="ok" if ready else "starting", version=VERSION, checks=checks)


@router.get(
    "/metrics",
    summary="Figures for Prometheus",
    response_class=Response,
    responses={200: {"content": {"text/plain": {"schema": {"type": "string"}}}}},
)
async def metrics() -> Response:
    """Counters and gauges in the Prometheus text format."""
    return Response(generate_latest(), headers={"Content-Type": CONTENT_TYPE_LATEST})
