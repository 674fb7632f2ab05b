"""A running service asked by a command."""

from __future__ import annotations

import json
from typing import Annotated, Any, Literal

import typer

from app.cli.output import CommandError, Exit

Service = Annotated[str, typer.Option(help="Address of the service.", metavar="URL")]
DEFAULT_SERVICE = "http://127.0.0.1:8000"


def asked(
    service: str,
    method: Literal["GET", "POST"],
    path: str,
    params: dict[str, Any],
    *,
    content: bytes | None = None,
    timeout_s: float = 30.0,
) -> dict[str, Any]:
    """The service's answer as JSON; raises as ``fetched``."""
    body = fetched(service, method, path, params, content=content, timeout_s=timeout_s)
    try:
        told: dict[str, Any] = json.loads(body)
    except ValueError as error:
        raise _nobody(service, error) from error
    return told


def fetched(
    service: str,
    method: Literal["GET", "POST"],
    path: str,
    params: dict[str, Any],
    *,
    content: bytes | None = None,
    timeout_s: float = 30.0,
) -> bytes:
    """The service's answer as it is.

    Raises
    ------
    CommandError
        None answers there, or it refuses; bad input where it says so.
    """
    import httpx

    url = f"{service.rstrip('/')}/api/v1/{path}"
    try:
        answer = httpx.request(method, url, params=params, content=content, timeout=timeout_s)
        if answer.status_code == 200:
            return answer.content
        body: dict[str, Any] = answer.json()
    except (httpx.HTTPError, httpx.InvalidURL, json.JSONDecodeError) as error:
        raise _nobody(service, error) from error
    if answer.status_code == 422:
        raise CommandError(str(body["detail"]), Exit.BAD_INPUT)
    raise CommandError(str(body.get("detail", answer.status_code)))


def _nobody(service: str, error: Exception) -> CommandError:
    return CommandError(
        f"no service answers at {service}: {error or type(error).__name__}; start it, or give --service"
    )
