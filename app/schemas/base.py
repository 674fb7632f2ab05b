"""What every body is made of."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict


class Strict(BaseModel):
    """A request body: unknown members, NaN and infinities are refused."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, strict=True)


class FindingOut(BaseModel):
    """One thing wrong, or worth knowing, about a scenario."""

    feature: str
    rule: str
    message: str
    fix: str
    severity: Literal["error", "warning"]
