"""The body of a probe's answer."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, Field


class Health(BaseModel):
    """A probe's answer."""

    status: Literal["ok", "starting", "failing"] = Field(
        description="starting: workers are compiling their kernels. failing: nothing can be kept."
    )
    version: str
    checks: dict[str, bool] = Field(
        default_factory=dict,
        description="`database`: it can be read and written. `workers`: planning processes are warm. "
        "`links`: the process that holds the links to the vehicles answers.",
    )
