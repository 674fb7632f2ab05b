"""Bodies of answers about kept scenarios."""

from __future__ import annotations

from datetime import datetime
from typing import Any, Self

from pydantic import BaseModel, Field

from app.services.records import KeptScenario


class ScenarioOut(BaseModel):
    """A scenario people are at work on, without its text."""

    id: str
    name: str
    revision: int = Field(description="Counts its changes; send it back as `If-Match`.", examples=[3])
    scenario_hash: str = Field(description="Plans made of this text have the same.")
    created_at: datetime
    changed_at: datetime

    @classmethod
    def of(cls, record: KeptScenario) -> Self:
        """The answer for a record."""
        return cls(
            id=record.id,
            name=record.name,
            revision=record.revision,
            scenario_hash=record.scenario_hash,
            created_at=record.created_at,
            changed_at=record.changed_at,
        )


class ScenarioTextOut(ScenarioOut):
    """A scenario people are at work on."""

    scenario: dict[str, Any] = Field(description="As it was last saved; it may be unfinished.")

    @staticmethod
    def written(record: KeptScenario, text: str) -> str:
        """The answer for a record and its text, as JSON: the text may be large, and is JSON already."""
        head = ScenarioOut.of(record).model_dump_json()
        return f'{head[:-1]},"scenario":{text}}}'


class ScenarioList(BaseModel):
    """Kept scenarios, the one changed last first."""

    scenarios: list[ScenarioOut]
    total: int
