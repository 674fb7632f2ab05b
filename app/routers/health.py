"""Probes and figures for those who keep the service running."""

from __future__ import annotations

import contextlib

from fastapi import APIRouter, Response
from prometheus_client import CONTENT_TYPE_LATEST

from app.deps import HouseDep
from app.schemas.health import Health
from app.services.metrics import exposition
from app.services.plans.pool import WorkerDiedError
from app.version import VERSION

router = APIRouter(tags=["health"])


@router.get("/health/live", summary="Is the process alive?")
async def live() -> Health:
    """200 as long as the event loop turns."""
    return Health(status="ok", version=VERSION)


@router.get(
    "/health/ready",
    summary="Can it plan?",
    responses={
        503: {"model": Health, "description": "The check that is false says why: see `checks`."},
    },
)
async def ready(house: HouseDep, response: Response) -> Health:
    """200 once the database can be read and written and a planning process is warm.

    Workers that ended are replaced by this; until they are warm it is 503.
    """
    pools = (house.pool, house.desk.pool)
    for pool in pools:
        with contextlib.suppress(WorkerDiedError):
            await pool.mend()
    checks = {
        "database": await house.database.answers(),
        "workers": all(pool.ready for pool in pools),
    }
    if house.keeper is not None:
        checks["links"] = await house.keeper.client.answers()
    if all(checks.values()):
        return Health(status="ok", version=VERSION, checks=checks)
    response.status_code = 503
    return Health(status="starting" if checks["database"] else "failing", version=VERSION, checks=checks)


@router.get(
    "/metrics",
    summary="Figures for Prometheus",
    response_class=Response,
    responses={200: {"content": {"text/plain": {"schema": {"type": "string"}}}}},
)
async def metrics(house: HouseDep) -> Response:
    """Counters and gauges in the Prometheus text format."""
    others = "" if house.keeper is None else await house.keeper.metrics()
    return Response(exposition(others), headers={"Content-Type": CONTENT_TYPE_LATEST})
