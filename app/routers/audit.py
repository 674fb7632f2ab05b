"""The audit: what was ordered of vehicles, by whom, and what became of it."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Annotated

from fastapi import APIRouter, Query
from pydantic import AfterValidator, BeforeValidator

from app.deps import AuditDep
from app.problems import responses
from app.routers.answers import PageLimit, PageOffset
from app.schemas.audit import AuditEntryOut, AuditList
from app.services.records import AuditKind
from app.services.store.audit import AuditFilter

router = APIRouter(prefix="/api/v1/audit", tags=["audit"])


def _utc(moment: datetime) -> datetime:
    try:
        return moment.replace(tzinfo=moment.tzinfo or UTC).astimezone(UTC)
    except OverflowError:
        raise ValueError("the moment is beyond the years 1 to 9999 of UTC") from None


def _dated(value: str) -> str:
    # A bare number would be taken for seconds since 1970, a year for half an hour of that day.
    if value.strip().lstrip("+-").replace(".", "", 1).isdigit():
        raise ValueError("a moment is written as in 2026-11-29T10:00:00Z")
    return value


Moment = Annotated[datetime, BeforeValidator(_dated), AfterValidator(_utc)]


@router.get("", summary="List what was ordered", responses=responses(422))
async def list_entries(
    audit: AuditDep,
    limit: PageLimit = 50,
    offset: PageOffset = 0,
    vehicle: Annotated[str | None, Query(max_length=200, description="Its id, or its name.")] = None,
    kind: AuditKind | None = None,
    since: Annotated[Moment | None, Query(description="At or after; UTC without a zone.")] = None,
    until: Annotated[Moment | None, Query(description="Before; UTC without a zone.")] = None,
) -> AuditList:
    """Orders, uploads, clearings, overrides, acknowledgements, changes of signing; newest first.

    Each is written before it is sent, and completed with what became of it. What cannot be written is not
    sent, but for `rtl`, `land`, `hold`, `pause`, `disarm` and `sensor_off`: these go out, and are written
    later.
    """
    which = AuditFilter(vehicle, kind, since, until)
    entries, total = await audit.newest(which, limit, offset)
    return AuditList(entries=[AuditEntryOut.of(entry) for entry in entries], total=total)
