"""Scenarios as they come in: read, named, hashed, judged; in a worker, for their size is anybody's."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass

from app.services.documents import name_of, read_object, write_json
from app.services.scenarios.validation import Verdict
from planner.geojson import scenario_hash


@dataclass(frozen=True, slots=True)
class Received:
    """What the services keep of a scenario.

    Parameters
    ----------
    text
        As it is stored: the same document, written one way.
    digest
        SHA-256 of the text.
    scenario_hash
        Of what it asks for, whatever the order of its members.
    """

    text: str
    digest: str
    name: str
    scenario_hash: str


def received(body: bytes) -> Received:
    """Read a scenario; raises RefusedError where it is no JSON object."""
    document = read_object(body)
    text = write_json(document)
    digest = hashlib.sha256(text.encode()).hexdigest()
    return Received(text, digest, name_of(document), scenario_hash(document))


def judged(
    body: bytes, judge: Callable[..., Verdict], terrain_folder: str | None
) -> tuple[Received, Verdict]:
    """Read a scenario and judge it.

    Parameters
    ----------
    terrain_folder
        Of uploaded rasters: the judge's second argument for a scenario that names one.
    """
    document = read_object(body)
    named = any(document.get(name) is not None for name in ("terrain", "importance_raster"))
    folder = (terrain_folder,) if named and terrain_folder is not None else ()
    return received(body), judge(document, *folder)
