"""What several routers ask and answer alike: pages of lists, ground seen, records of plans just posted."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import Depends, Query, Response

from app.deps import PlanningDep, SettingsDep
from app.schemas.plans import PlanOut
from app.services.records import PlanRecord

GEOJSON = "application/geo+json"
GEOJSON_ANSWER: dict[int | str, dict[str, Any]] = {
    200: {"content": {GEOJSON: {"schema": {"type": "object"}}}}
}
GEOTIFF = "image/tiff; application=geotiff"
GEOTIFF_ANSWER: dict[int | str, dict[str, Any]] = {
    200: {"content": {GEOTIFF: {"schema": {"type": "string", "format": "binary"}}}}
}
RegionName = Annotated[str | None, Query(max_length=200, description="One region; all when left out.")]
PageLimit = Annotated[int, Query(ge=1, le=1000)]
PageOffset = Annotated[int, Query(ge=0, le=2**31)]
Wait = Annotated[
    float,
    Query(
        ge=0,
        le=3600,
        description="Seconds to hold the answer for the plan's end, `SWATHPLAN_MAX_WAIT_S` at most.",
    ),
]


class PostedPlan:
    """The answer to whoever posts a plan: at once, or at its end where that comes within `wait`."""

    def __init__(
        self, response: Response, planning: PlanningDep, settings: SettingsDep, wait: Wait = 0.0
    ) -> None:
        self._response, self._planning = response, planning
        self._wait_s = min(wait, settings.max_wait_s)

    async def of(self, record: PlanRecord) -> PlanOut:
        """Its record as it is then, and its place in `Location`."""
        if self._wait_s > 0 and not record.ended:
            record = await self._planning.wait(record.id, self._wait_s)
        self._response.headers["Location"] = f"/api/v1/plans/{record.id}"
        return PlanOut.of(record)


PostedDep = Annotated[PostedPlan, Depends()]
