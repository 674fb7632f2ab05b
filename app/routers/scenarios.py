"""Scenarios: kept while people are at work on them, judged without planning, read from other files."""

from __future__ import annotations

import re
from dataclasses import asdict
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Header, Query, Request, Response

from app.deps import DeskDep, PlanningDep, ScenariosDep
from app.problems import responses
from app.routers.answers import PageLimit, PageOffset
from app.routers.bodies import DRAFT_BODY, SCENARIO_BODY
from app.schemas.base import FindingOut
from app.schemas.plans import ValidationOut
from app.schemas.scenarios import ScenarioList, ScenarioOut, ScenarioTextOut
from app.services.documents import write_json
from app.services.errors import RefusedError
from app.services.pages import total_of
from app.services.plans.work import finding_json
from app.services.scenarios.regions_import import FORMAT_OF_MEDIA_TYPE, ImportOptions, import_file
from planner.errors import Finding

router = APIRouter(prefix="/api/v1/scenarios", tags=["scenarios"])

#: An ETag; quoted, and the weak form, which proxies make of the strong one, counts too.
_TAG = re.compile(r'(?:W/)?"?(\d{1,9})"?')
IfMatch = Annotated[
    str,
    Header(
        max_length=40,
        description="The revision it was read at, as `ETag` gave it; `*` for any.",
        examples=['"3"'],
    ),
]


def _revision(if_match: str) -> int | None:
    """The revision an ``If-Match`` names; None for any."""
    if if_match.strip() == "*":
        return None
    found = _TAG.fullmatch(if_match.strip())
    if found is None:
        message = "If-Match names no revision"
        raise RefusedError(message, (Finding("If-Match", "if-match", message, 'send the ETag, e.g. "3"'),))
    return int(found[1])


@router.post(
    "",
    status_code=201,
    summary="Keep a scenario",
    responses=responses(422),
    openapi_extra={"requestBody": DRAFT_BODY},
)
async def keep(request: Request, scenarios: ScenariosDep, response: Response) -> ScenarioOut:
    """Keep a scenario people are at work on; it may be unfinished, and is not judged."""
    record = await scenarios.add(await request.body())
    response.headers["Location"] = f"/api/v1/scenarios/{record.id}"
    response.headers["ETag"] = f'"{record.revision}"'
    return ScenarioOut.of(record)


@router.get("", summary="List kept scenarios", responses=responses(422))
async def list_kept(
    scenarios: ScenariosDep,
    limit: PageLimit = 50,
    offset: PageOffset = 0,
) -> ScenarioList:
    """Kept scenarios without their texts, the one changed last first."""
    records = await scenarios.newest(limit, offset)
    total = await total_of(len(records), limit, offset, scenarios.count)
    return ScenarioList(scenarios=[ScenarioOut.of(record) for record in records], total=total)


@router.get(
    "/{scenario_id}",
    summary="Read a kept scenario",
    response_class=Response,
    responses=responses(404) | {200: {"model": ScenarioTextOut}},
)
async def get_kept(scenario_id: str, scenarios: ScenariosDep) -> Response:
    """The scenario and its revision, which is also the `ETag`."""
    record, text = await scenarios.read(scenario_id)
    return Response(
        ScenarioTextOut.written(record, text),
        media_type="application/json",
        headers={"ETag": f'"{record.revision}"'},
    )


@router.put(
    "/{scenario_id}",
    summary="Change a kept scenario",
    responses=responses(404, 412, 422),
    openapi_extra={"requestBody": DRAFT_BODY},
)
async def change(
    scenario_id: str, request: Request, scenarios: ScenariosDep, response: Response, if_match: IfMatch
) -> ScenarioOut:
    """Put another text in its place; plans made of the one before are stale from now on.

    412 when somebody else has changed it since the revision in `If-Match`: read it again, or keep this one as
    a scenario of its own. The same text again changes nothing, not even the revision.
    """
    record = await scenarios.change(scenario_id, await request.body(), _revision(if_match))
    response.headers["ETag"] = f'"{record.revision}"'
    return ScenarioOut.of(record)


@router.delete(
    "/{scenario_id}", status_code=204, summary="Delete a kept scenario", responses=responses(404, 412, 422)
)
async def remove(scenario_id: str, scenarios: ScenariosDep, if_match: IfMatch = "*") -> None:
    """Forget it; plans made of it stay, and are stale."""
    await scenarios.remove(scenario_id, _revision(if_match))


@router.post(
    "/validate",
    summary="Validate a scenario",
    responses=responses(422),
    openapi_extra={"requestBody": SCENARIO_BODY},
)
async def validate(request: Request, planning: PlanningDep) -> ValidationOut:
    """200 with warnings, or 422 with every rule the scenario breaks; plans nothing."""
    verdict = await planning.validate(await request.body())
    if verdict.errors:
        raise RefusedError("the scenario is refused", verdict.errors + verdict.warnings)
    return ValidationOut(
        findings=[FindingOut.model_validate(finding_json(finding)) for finding in verdict.warnings]
    )


_BINARY: dict[str, Any] = {"schema": {"type": "string", "format": "binary"}}
IMPORT_BODY: dict[str, Any] = {
    "required": True,
    "description": "The file: KML, KMZ, GPX, GeoJSON, or an archive with a shapefile.",
    "content": dict.fromkeys((*FORMAT_OF_MEDIA_TYPE, "application/zip", "application/octet-stream"), _BINARY),
}
IMPORT_ANSWER: dict[int | str, dict[str, Any]] = {
    200: {
        "description": "Features of a scenario; `notes` says what was assumed or left out.",
        "content": {
            "application/geo+json": {
                "schema": {
                    "type": "object",
                    "required": ["type", "features", "format", "shapes", "left_out", "notes"],
                    "properties": {
                        "type": {"const": "FeatureCollection"},
                        "features": {"type": "array", "items": {"type": "object"}},
                        "format": {"type": "string"},
                        "shapes": {
                            "type": "array",
                            "description": "What each shape became (`role`, `none` where it is left out), "
                            "why, whether that is `in_doubt`, and the names of its `features`.",
                            "items": {
                                "type": "object",
                                "properties": {
                                    "number": {"type": "integer"},
                                    "name": {"type": "string"},
                                    "folders": {"type": "array", "items": {"type": "string"}},
                                    "kind": {"enum": ["polygon", "line", "point"]},
                                    "role": {"type": "string"},
                                    "why": {"type": "string"},
                                    "in_doubt": {"type": "boolean"},
                                    "features": {"type": "array", "items": {"type": "string"}},
                                },
                            },
                        },
                        "left_out": {
                            "type": "array",
                            "description": "Findings of shapes that take no part, or not as they are.",
                            "items": {"type": "object"},
                        },
                        "notes": {"type": "array", "items": {"type": "string"}},
                    },
                },
                "example": {
                    "type": "FeatureCollection",
                    "features": [
                        {
                            "type": "Feature",
                            "id": "north field",
                            "geometry": {
                                "type": "Polygon",
                                "coordinates": [[[8.5, 47.3], [8.6, 47.3], [8.6, 47.4], [8.5, 47.3]]],
                            },
                            "properties": {"role": "roi", "name": "north field"},
                        }
                    ],
                    "format": "kml",
                    "shapes": [
                        {
                            "number": 1,
                            "name": "north field",
                            "folders": [],
                            "kind": "polygon",
                            "role": "roi",
                            "why": "nothing says otherwise",
                            "in_doubt": False,
                            "features": ["north field"],
                        }
                    ],
                    "left_out": [],
                    "notes": [],
                },
            }
        },
    }
}
RegionFormat = Literal[
    "kml", "kmz", "gpx", "gml", "shp", "shapefile", "zip", "geojson", "geojsonl", "esrijson", "wkt", "csv",
    "mission",
]  # fmt: skip
Metres = Annotated[float | None, Query(gt=0, le=1_000_000, description="For shapes that do not say theirs.")]


@router.post(
    "/import",
    summary="Turn a file of regions into features",
    response_class=Response,
    responses=responses(422) | IMPORT_ANSWER,
    openapi_extra={"requestBody": IMPORT_BODY},
)
async def import_regions(
    request: Request,
    desk: DeskDep,
    form: Annotated[
        RegionFormat | None,
        Query(
            alias="format", description="Format of the body; found by media type and content when left out."
        ),
    ] = None,
    role: Annotated[
        Literal["roi", "threat", "no_fly", "area", "obstacle", "start", "end", "base", "importance"] | None,
        Query(
            description="Role of shapes that no value, name or folder of the file gives one "
            "[`roi` for polygons and lines; points are left out]."
        ),
    ] = None,
    role_of: Annotated[
        list[str],
        Query(
            max_length=5000,
            description="Role of one shape, or of all in a folder or layer, by name or number, before all "
            "that the file says: `NFZ north=no_fly`, `Buildings=obstacle`, `#3=none` (left out).",
        ),
    ] = [],  # noqa: B006
    name: Annotated[
        str, Query(max_length=300, description="The file's name; its words count like a folder's.")
    ] = "",
    width_m: Metres = None,
    radius_m: Metres = None,
    height_m: Metres = None,
    crs: Annotated[
        str | None,
        Query(
            max_length=20,
            description="Reference system of the coordinates [the file's own], e.g. EPSG:32611.",
        ),
    ] = None,
) -> Response:
    """A FeatureCollection to merge into a scenario; stores and plans nothing.

    Polygons become regions and lines corridors of `width_m`, unless the file's own `role` values, names,
    folders or other values (`No-fly zones`, `Operating area`, `Start` …) say otherwise; points take the part
    that these say, or none. Where words forbid flying a shape forbids it. One whose role is in doubt has
    `role_in_doubt`, and the scenario is refused until `role`, `role_of` or the map has settled it. `shapes`
    says what each became and why, `left_out` what cannot be taken as it is.
    """
    media_type = request.headers.get("content-type", "").split(";")[0].strip().lower()
    options = ImportOptions(role, width_m, radius_m, height_m, crs, file_name=name)
    found = await desk.run(
        "file",
        import_file,
        await request.body(),
        options,
        form or FORMAT_OF_MEDIA_TYPE.get(media_type),
        None,
        role_of,
    )
    answer = found.collection | {
        "format": found.format,
        "shapes": [asdict(account) for account in found.shapes],
        "left_out": [finding_json(finding) for finding in found.left_out],
        "notes": list(found.notes),
    }
    return Response(write_json(answer), media_type="application/geo+json")
