"""Which status an upload is answered with."""

from __future__ import annotations

from collections.abc import Sequence

from pydantic import BaseModel

from app.services.errors import NotHeldError
from planner.errors import Finding


def require_held(said: str, failings: Sequence[Finding], told: BaseModel) -> None:
    """Let an upload pass of which nothing was refused and nothing differs.

    Parameters
    ----------
    told
        The answer; the problem document has its members too.

    Raises
    ------
    NotHeldError
        Where something was, or does.
    """
    if failings:
        detail = f"{said}: {failings[0].feature}: {failings[0].message}"
        raise NotHeldError(detail, tuple(failings), told.model_dump(mode="json"))
