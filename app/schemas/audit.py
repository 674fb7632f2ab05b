"""Bodies of answers about the audit."""

from __future__ import annotations

from datetime import datetime
from typing import Any, Self

from pydantic import BaseModel, Field

from app.services.records import AuditEntry, AuditKind


class AuditEntryOut(BaseModel):
    """What somebody ordered of a vehicle, and what became of it."""

    number: int
    at: datetime
    actor: str = Field(
        description="`local` as long as the service knows no users; `service`: it did so by itself.",
        examples=["local"],
    )
    kind: AuditKind
    vehicle_id: str
    vehicle_name: str
    what: dict[str, Any] = Field(
        description="The command and its options; the plan and its parts; the reason of an override.",
        examples=[{"command": "goto_item", "seq": 12}],
    )
    outcome: str = Field(
        description="`pending` until it is settled; of an order as the order's, of an upload or a clearing "
        "`accepted`, `different`, `refused`, `unknown`.",
        examples=["done"],
    )
    reason: str = Field(description="In words; empty where nothing is to be said.")
    ended_at: datetime | None

    @classmethod
    def of(cls, entry: AuditEntry) -> Self:
        """The answer for an entry."""
        return cls.model_validate(entry, from_attributes=True)


class AuditList(BaseModel):
    """Entries, newest first."""

    entries: list[AuditEntryOut]
    total: int = Field(description="How many there are, on this page and on others.")
