"""One try at a plan in a worker: a result, or a reason there is none."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import structlog

from app.services.plans.pool import Pool, WorkerDiedError
from app.services.plans.work import WorkResult

log = structlog.get_logger(__name__)


def failure(kind: str, title: str, detail: str) -> dict[str, Any]:
    """The ``error`` of a failed plan."""
    return {"type": kind, "title": title, "detail": detail, "errors": []}


async def attempted(
    pool: Pool, task: Callable[..., WorkResult], arguments: tuple[Any, ...], time_limit_s: float
) -> WorkResult:
    """What a task gives in a worker; that it took too long, or that its process died, is a reason too."""
    try:
        result = await pool.run(task, arguments, time_limit_s)
    except TimeoutError:
        detail = f"planning took longer than {time_limit_s:g} s and was stopped"
        return WorkResult(error=failure("time-limit", "The time limit passed", detail))
    except WorkerDiedError as error:
        detail = f"{error}; other plans go on, post the scenario again"
        return WorkResult(error=failure("worker-died", "The planning process died", detail))
    except Exception as error:
        # The planner broke its word; the client learns that much and the log the rest.
        log.error("planner failed", exc_info=error)
        detail = "the planner failed for a reason it did not foresee; the service's log has the details"
        return WorkResult(error=failure("internal", "Internal error", detail))
    assert isinstance(result, WorkResult)
    return result
