"""Plans whose end could not be written: failed for everybody, and written once the database takes it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import datetime
from typing import Any

from app.services.records import PlanRecord


@dataclass(frozen=True, slots=True)
class Failure:
    """How a plan ended that no row tells of yet."""

    error: dict[str, Any]
    stage: str | None
    progress: float
    ended_at: datetime


class Unwritten:
    """Failures by the ids of their plans, while this service runs; the next one fails those plans itself."""

    def __init__(self) -> None:
        self._failures: dict[str, Failure] = {}

    def __contains__(self, plan_id: str) -> bool:
        return plan_id in self._failures

    @property
    def ids(self) -> tuple[str, ...]:
        """Of the plans concerned."""
        return tuple(self._failures)

    def get(self, plan_id: str) -> Failure:
        """How one ended."""
        return self._failures[plan_id]

    def add(self, plan_id: str, failure: Failure) -> None:
        """Remember one."""
        self._failures[plan_id] = failure

    def drop(self, plan_id: str) -> None:
        """It is written now, or its plan is deleted."""
        self._failures.pop(plan_id, None)

    def seen(self, record: PlanRecord) -> PlanRecord:
        """A record as it is, whatever its row still says."""
        failure = self._failures.get(record.id)
        if failure is None:
            return record
        return replace(
            record,
            state="failed",
            error=failure.error,
            stage=failure.stage,
            progress=failure.progress,
            ended_at=failure.ended_at,
        )
