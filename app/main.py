"""The web application: services, routes, middleware and the map, put together."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi
from fastapi.responses import HTMLResponse
from starlette.routing import Match, Mount
from starlette.types import Scope

from app import problems
from app.assembly import assemble, limits_of
from app.map_files import MapFiles
from app.routers import (
    aircraft,
    artefacts,
    audit,
    flights,
    health,
    interface,
    plans,
    scenarios,
    sensors,
    sorties,
    terrain,
    vehicles,
)
from app.services.house import House
from app.services.limits import Limits
from app.settings import Settings
from app.version import VERSION

DESCRIPTION = """Plans how one aircraft or several see regions of interest, or search ground, with cameras and
side-looking radars, among threats and zones, and puts the missions into ArduPilot and PX4 vehicles.

Geometry is RFC 7946 GeoJSON. Every error is an RFC 9457 problem document."""

TAGS = [
    {"name": "plans", "description": "Scenarios become plans."},
    {"name": "artefacts", "description": "What a plan gives: GeoJSON, missions, a report."},
    {"name": "scenarios", "description": "Scenarios judged without planning them."},
    {"name": "sensors", "description": "Cameras and radars that scenarios may name."},
    {"name": "aircraft", "description": "Airframes that scenarios may name."},
    {
        "name": "terrain",
        "description": "Rasters: of elevation, for scenarios to lie on, and of importance, for searches.",
    },
    {"name": "vehicles", "description": "Connected vehicles: state, missions, commands."},
    {"name": "flights", "description": "What was flown, and what was seen."},
    {"name": "audit", "description": "What was ordered of vehicles, and what became of it."},
    {"name": "health", "description": "Probes and figures."},
]

NO_MAP = """<!doctype html><html lang="en"><meta charset="utf-8"><title>Swathplan</title>
<body style="font: 16px/1.5 system-ui; max-width: 40em; margin: 4em auto; padding: 0 1em">
<h1>Swathplan</h1><p>The service runs, but the map has not been built. <code>make run</code> builds it and
starts the service.</p>
<p>The interface for programs is described at <a href="/docs">/docs</a>.</p>"""


def create_app(settings: Settings | None = None, build_house: Callable[[Limits], House] = House) -> FastAPI:
    """The application for some settings; services start with its lifespan."""
    settings = settings or Settings()

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        house = build_house(limits_of(settings))
        app.state.house = house
        try:
            try:
                await house.open()
            except Exception as error:
                app.state.start_failure = error
                raise
            yield
        finally:
            await house.close()

    modules = (
        plans, artefacts, scenarios, sensors, aircraft, terrain, vehicles, flights, sorties, audit, health,
        interface,
    )  # fmt: skip
    app = assemble(
        settings,
        lifespan,
        [module.router for module in modules],
        title="Swathplan",
        version=VERSION,
        description=DESCRIPTION,
        openapi_tags=TAGS,
    )
    _add_map(app, settings)
    app.openapi = lambda: _openapi(app)  # type: ignore[method-assign]
    return app


class _MapMount(Mount):
    """The map under every path but the interface's, where a wrong method is a 405 and not a missing file."""

    _OTHERS = ("/api/", "/health/", "/metrics", "/openapi.json", "/docs", "/redoc")

    def matches(self, scope: Scope) -> tuple[Match, Scope]:
        if scope["path"].startswith(self._OTHERS):
            return Match.NONE, {}
        return super().matches(scope)


def _add_map(app: FastAPI, settings: Settings) -> None:
    folder = settings.web_map
    if folder is not None:
        app.router.routes.append(_MapMount("/", MapFiles(directory=folder, html=True), name="map"))
        return

    @app.get("/", include_in_schema=False)
    async def no_map() -> HTMLResponse:
        policy = "default-src 'none'; style-src 'unsafe-inline'; frame-ancestors 'none'"
        return HTMLResponse(NO_MAP, headers={"Content-Security-Policy": policy})


def _openapi(app: FastAPI) -> dict[str, Any]:
    if app.openapi_schema is None:
        schema = get_openapi(
            title=app.title,
            version=app.version,
            description=app.description,
            routes=app.routes,
            tags=app.openapi_tags,
        )
        components = schema.setdefault("components", {}).setdefault("schemas", {})
        problem = problems.Problem.model_json_schema(ref_template="#/components/schemas/{model}")
        components |= problem.pop("$defs")
        components["Problem"] = problem
        # The framework's own schema of validation errors is never sent.
        for name in ("HTTPValidationError", "ValidationError"):
            components.pop(name, None)
        for path in schema["paths"].values():
            for operation in path.values():
                answers = operation["responses"]
                if "422" in answers:
                    answers["422"] = problems.responses(422)[422]
                answers.setdefault(
                    "default", problems.responses(500)[500] | {"description": "Any other error"}
                )
        app.openapi_schema = schema
    return app.openapi_schema
