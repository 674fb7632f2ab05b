"""Plans and mission files on the command line: whichever a file is, as the text of a plan's document."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from app.cli.output import CommandError, Exit, read_bytes, read_document

if TYPE_CHECKING:
    from app.services.plans.mission_scene import FileChoice
    from planner.airspace.terrain import Terrain


@dataclass(frozen=True, slots=True)
class Given:
    """What was named on the command line.

    Parameters
    ----------
    is_mission
        Whether it was a mission file, judged here; else a plan, judged when it was made.
    """

    text: str
    is_mission: bool


def given(source: str, choice: FileChoice, scenario: str | None, terrain: str | None) -> Given:
    """The plan of a file or standard input; raises CommandError where it is neither.

    Parameters
    ----------
    scenario
        File of the scenario that a mission file is judged in.
    terrain
        Elevation file that it is judged over.
    """
    from app.services.documents import write_json
    from app.services.errors import RefusedError
    from app.services.plans.mission_files import filed

    content = read_bytes(source)
    if not _is_mission(content):
        if terrain is not None:
            raise CommandError("--terrain is for mission files: a plan is judged already", Exit.BAD_INPUT)
        return Given(write_json(_checked(content, source)), False)
    asked = None if scenario is None else read_document(scenario)
    ground: Terrain | None = None
    if terrain is not None:
        from dataclasses import replace

        from app.cli.planning import with_raster

        asked_or_bare, ground = with_raster(asked or {}, terrain, "terrain")
        asked = None if asked is None else asked_or_bare
        choice = replace(choice, terrain=None if asked is not None else ground.name)

    def terrains(name: str) -> Terrain | None:
        return ground if ground is not None and ground.name == name else None

    try:
        plan = filed(content, choice, None if asked is None else write_json(asked), terrains)
    except RefusedError as error:
        raise CommandError(f"{source}: {error}", Exit.BAD_INPUT, error.findings) from error
    return Given(plan.plan, True)


def _is_mission(content: bytes) -> bool:
    """Whether a file is a mission: any text but JSON, and JSON of QGroundControl's."""
    import json

    from mavlink.formats import FormatError, kind_of
    from mavlink.formats.reading import decoded

    try:
        text = decoded(content)
        if kind_of(text) != "plan":
            return True
        document = json.loads(text.lstrip("\ufeff"))
    except (FormatError, ValueError, RecursionError):
        return False
    if not isinstance(document, dict) or document.get("type") is not None:
        return False
    return "mission" in document or "items" in document


def _checked(content: bytes, source: str) -> dict[str, object]:
    """A plan's document that can be read as one."""
    from app.services.documents import read_object
    from app.services.errors import RefusedError
    from planner.errors import ScenarioError
    from planner.geojson import read_plan

    name = "standard input" if source == "-" else source
    try:
        document = read_object(content)
    except RefusedError as error:
        raise CommandError(f"{name} is not understood", Exit.BAD_INPUT, error.findings) from error
    try:
        read_plan(document)
    except ScenarioError as error:
        raise CommandError(f"{source} is no plan", Exit.BAD_INPUT, error.findings) from error
    return document
