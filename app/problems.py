"""Every refusal as an RFC 9457 problem document; the one table from error classes to statuses."""

from __future__ import annotations

from collections.abc import Mapping
from http import HTTPStatus
from typing import Any

import structlog
from fastapi import FastAPI, Request, Response
from fastapi.exceptions import RequestValidationError
from pydantic import BaseModel, ConfigDict, Field
from starlette.exceptions import HTTPException

from app.services import errors
from app.services.documents import write_json
from app.services.plans.work import finding_json

log = structlog.get_logger(__name__)

MEDIA_TYPE = "application/problem+json"
TYPE_PREFIX = "urn:problem-type:swathplan:"

#: Class, status, type, title. The first class that matches counts.
TABLE: tuple[tuple[type[errors.ServiceError], int, str, str], ...] = (
    (errors.NotFoundError, 404, "not-found", "There is no such thing"),
    (errors.BusyError, 409, "busy", "Another operation is at work"),
    (errors.ChangedError, 412, "scenario-changed", "Somebody else has changed the scenario"),
    (errors.ConflictError, 409, "conflict", "Not possible in the present state"),
    (errors.UnsafeError, 409, "unsafe", "Not to be flown without an explicit override"),
    (errors.RefusedError, 422, "refused", "The input is refused"),
    (errors.OverloadedError, 429, "overloaded", "No room for more work now"),
    (errors.StorageError, 503, "storage", "Nothing can be kept now"),
    (errors.ClientGoneError, 499, "client-gone", "Nobody waits for the answer"),
    # no 502: a 5xx means that the service is broken, and it is not; 504 is the vehicle's silence alone
    (errors.LinkError, 409, "vehicle-unreachable", "The vehicle cannot be reached"),
    (errors.NotHeldError, 409, "not-held", "The vehicle does not hold what was meant"),
    (errors.CommandRefusedError, 409, "command-refused", "The command is refused"),
    (errors.CommandOvertakenError, 409, "command-overtaken", "A newer command has overtaken it"),
    (errors.CommandUnknownError, 504, "command-unknown", "Nobody can tell whether it was carried out"),
)

#: When to try again what the database did not take, seconds.
_RETRY_AFTER_S = 10


class ProblemEntry(BaseModel):
    """One reason of a refusal."""

    model_config = ConfigDict(extra="allow")

    feature: str = Field(description="Feature of the scenario, or member of the request, concerned.")
    rule: str = Field(description="Machine-readable name of the rule.")
    message: str = Field(description="What is wrong, with the offending value.")
    fix: str = Field(description="What to change.")


class Problem(BaseModel):
    """A problem document (RFC 9457)."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {
                    "type": TYPE_PREFIX + "refused",
                    "title": "The input is refused",
                    "status": 422,
                    "detail": "the scenario is refused: R2: the ring crosses itself at 33.5015, -117.7401",
                    "instance": "/api/v1/plans",
                    "errors": [
                        {
                            "feature": "R2",
                            "rule": "ring-self-intersects",
                            "message": "the ring crosses itself at 33.5015, -117.7401",
                            "fix": "draw the ring so that its sides meet at its corners alone",
                        }
                    ],
                }
            ]
        }
    )

    type: str = Field(description="URI that names the kind of problem.")
    title: str = Field(description="The kind in words; the same for each occurrence.")
    status: int = Field(description="HTTP status.")
    detail: str = Field(description="What happened this time.")
    instance: str = Field(description="Path of the request.")
    errors: list[ProblemEntry] = Field(default_factory=list, description="Every reason, not only the first.")


def problem_body(
    path: str,
    status: int,
    kind: str,
    title: str,
    detail: str,
    entries: list[dict[str, Any]] | None = None,
    members: Mapping[str, Any] | None = None,
) -> bytes:
    """A problem document as bytes, with further members where its kind has some."""
    document = {
        "type": TYPE_PREFIX + kind,
        "title": title,
        "status": status,
        "detail": detail,
        "instance": path,
        "errors": entries or [],
        **(members or {}),
    }
    return write_json(document).encode(errors="replace")


def problem_response(
    request: Request,
    status: int,
    kind: str,
    title: str,
    detail: str,
    entries: list[dict[str, Any]] | None = None,
    headers: Mapping[str, str] | None = None,
    members: Mapping[str, Any] | None = None,
) -> Response:
    """A problem document as an answer."""
    body = problem_body(request.url.path, status, kind, title, detail, entries, members)
    return Response(body, status, headers=dict(headers or {}), media_type=MEDIA_TYPE)


def service_problem(request: Request, error: Exception) -> Response:
    """Answer for an error of the services."""
    status, kind, title = next(
        ((s, k, t) for cls, s, k, t in TABLE if isinstance(error, cls)), (500, "internal", "Internal error")
    )
    entries = (
        [finding_json(finding) for finding in error.findings]
        if isinstance(error, errors.RefusedError | errors.UndoneError)
        else None
    )
    members = error.members if isinstance(error, errors.UndoneError) else None
    retry_after_s = _RETRY_AFTER_S if isinstance(error, errors.StorageError) else None
    if isinstance(error, errors.OverloadedError):
        retry_after_s = error.retry_after_s
    headers = None if retry_after_s is None else {"Retry-After": str(retry_after_s)}
    return problem_response(request, status, kind, title, str(error), entries, headers, members)


def http_problem(request: Request, error: Exception) -> Response:
    """Answer for what the framework refuses: unknown paths, methods not allowed, unreadable bodies."""
    assert isinstance(error, HTTPException)
    title = HTTPStatus(error.status_code).phrase
    detail = error.detail if isinstance(error.detail, str) else title
    if error.status_code == HTTPStatus.NOT_FOUND and detail == title:
        # of the routing: no path of ours, while what is not found by its id is told by the services
        detail = f"{request.url.path} is no path of this service: /docs lists all of them, and /openapi.json"
    elif error.status_code == HTTPStatus.METHOD_NOT_ALLOWED and detail == title:
        detail = f"{request.method} is not taken at {request.url.path}: see /docs"
    kind = title.lower().replace(" ", "-")
    return problem_response(request, error.status_code, kind, title, detail, headers=error.headers)


def _fix(request: Request, rule: str) -> str:
    # What curl sends with -d alone is taken for a form.
    if rule == "model_attributes_type" and "json" not in request.headers.get("content-type", ""):
        return "send a JSON object with the header Content-Type: application/json"
    return "see /openapi.json for what is taken here"


def validation_problem(request: Request, error: Exception) -> Response:
    """Answer for parameters and bodies that do not fit their schema; never repeats the input."""
    assert isinstance(error, RequestValidationError)
    entries = [
        {
            "feature": ".".join(str(part) for part in entry["loc"]),
            "rule": str(entry["type"]),
            "message": str(entry["msg"]),
            "fix": _fix(request, str(entry["type"])),
        }
        for entry in error.errors()
    ]
    first = f"{entries[0]['feature']}: {entries[0]['message']}" if entries else "the request is malformed"
    return problem_response(request, 422, "refused", "The input is refused", first, entries)


def install(app: FastAPI) -> None:
    """Let the application answer every refusal with a problem document."""
    app.add_exception_handler(errors.ServiceError, service_problem)
    app.add_exception_handler(HTTPException, http_problem)
    app.add_exception_handler(RequestValidationError, validation_problem)


def responses(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """The ``responses`` of a route for OpenAPI."""
    return {
        status: {
            "description": HTTPStatus(status).phrase,
            "content": {MEDIA_TYPE: {"schema": {"$ref": "#/components/schemas/Problem"}}},
        }
        for status in statuses
    }
