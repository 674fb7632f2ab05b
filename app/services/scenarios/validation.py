"""Scenarios judged at the edge, before anything is planned."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from planner.errors import Finding


@dataclass(frozen=True, slots=True)
class Verdict:
    """What is wrong with a scenario, and what is worth knowing."""

    errors: tuple[Finding, ...]
    warnings: tuple[Finding, ...]


def judge(document: Mapping[str, Any], terrain_folder: str | None = None) -> Verdict:
    """Every finding of the planner about a scenario document; plans nothing.

    ``terrain_folder`` is where uploaded rasters are.
    """
    from app.services.plans.fences import fence_findings
    from app.services.terrain.rasters import stored_terrain
    from planner.validate import findings

    terrains = None if terrain_folder is None else partial(stored_terrain, terrain_folder)
    found = findings(document, terrains, fence_findings)
    return Verdict(
        errors=tuple(finding for finding in found if finding.severity == "error"),
        warnings=tuple(finding for finding in found if finding.severity == "warning"),
    )
