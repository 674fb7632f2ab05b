"""What the services hand out: frozen records, without any web or database type."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import Any, Literal

PlanState = Literal["queued", "running", "done", "failed", "cancelled"]
ENDED: frozenset[PlanState] = frozenset({"done", "failed", "cancelled"})


@dataclass(frozen=True, slots=True)
class PlanRecord:
    """One request to plan and what became of it.

    Parameters
    ----------
    progress
        0 to 1 over the whole plan.
    summary
        Of a done plan: ``metrics``, ``violations``, ``methods``, ``scenario_hash``, ``planner_version``,
        ``seed``.
    error
        Of a failed one: ``type``, ``title``, ``detail`` and ``errors``, as in a problem document.
    """

    id: str
    name: str
    state: PlanState
    stage: str | None
    progress: float
    created_at: datetime
    started_at: datetime | None
    ended_at: datetime | None
    warnings: tuple[dict[str, Any], ...]
    summary: dict[str, Any] | None
    error: dict[str, Any] | None

    @property
    def ended(self) -> bool:
        """Whether nothing more will happen to it."""
        return self.state in ENDED
