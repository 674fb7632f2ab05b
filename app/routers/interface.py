"""The page that describes the interface: its OpenAPI description for people, with nothing fetched elsewhere.

FastAPI's own pages load their scripts from a content network, which an aircraft's ground station in the
field does not reach.
"""

from __future__ import annotations

import json
import secrets
from pathlib import Path
from typing import Any

from fastapi import APIRouter, Request
from fastapi.responses import HTMLResponse
from jinja2 import Environment, FileSystemLoader, select_autoescape
from markupsafe import Markup, escape

TEMPLATES = Path(__file__).resolve().parents[1] / "templates"
#: Of OpenAPI's path members, those that are calls.
METHODS = ("get", "post", "put", "patch", "delete")

router = APIRouter()


def _kind(schema: dict[str, Any]) -> Markup:
    """What a schema stands for in a few words; a named schema becomes a link to its table."""
    if "$ref" in schema:
        name = schema["$ref"].rsplit("/", 1)[-1]
        return Markup('<a href="#schema-{0}">{0}</a>').format(name)
    for union in ("anyOf", "oneOf", "allOf"):
        if union in schema:
            return Markup(" or ").join(_kind(part) for part in schema[union])
    if "const" in schema:
        return escape(json.dumps(schema["const"]))
    if "enum" in schema:
        return escape(", ".join(json.dumps(value) for value in schema["enum"]))
    kind = schema.get("type", "anything")
    if kind == "array":
        return Markup("list of {}").format(_kind(schema.get("items", {})))
    if kind == "object" and isinstance(schema.get("additionalProperties"), dict):
        return Markup("object of {}").format(_kind(schema["additionalProperties"]))
    words = {"null": "nothing", "integer": "whole number", "string": "text", "boolean": "true or false"}
    kinds = kind if isinstance(kind, list) else [kind]
    named = " or ".join(words.get(str(part), str(part)) for part in kinds)
    return escape(f"{named} ({schema['format']})" if "format" in schema else named)


def _text(value: Any) -> str:
    return value if isinstance(value, str) else json.dumps(value, indent=2, ensure_ascii=False)


def _samples(schemas: dict[str, Any], content: dict[str, Any]) -> list[tuple[str, str]]:
    """The examples of a body, each with its name: its own, else those of its schema."""
    if "examples" in content:
        return [(e.get("summary", name), _text(e["value"])) for name, e in content["examples"].items()]
    if "example" in content:
        return [("Example", _text(content["example"]))]
    schema = content["schema"]
    if "$ref" in schema:
        schema = schemas[schema["$ref"].rsplit("/", 1)[-1]]
    return [("Example", _text(value)) for value in schema.get("examples", [])]


def write_interface(description: dict[str, Any], nonce: str = "") -> str:
    """An OpenAPI description as one HTML page without outside parts.

    Parameters
    ----------
    nonce
        What the answer's content security policy lets run.
    """
    environment = Environment(
        loader=FileSystemLoader(TEMPLATES),
        autoescape=select_autoescape(default=True, default_for_string=True),
        trim_blocks=True,
        lstrip_blocks=True,
    )
    schemas = description["components"]["schemas"]
    environment.filters |= {"kind": _kind, "samples": lambda content: _samples(schemas, content)}
    operations = [
        {"parameters": [], **call, "path": path, "method": method}
        for path, item in description["paths"].items()
        for method, call in item.items()
        if method in METHODS
    ]
    return environment.get_template("interface.html.jinja").render(
        openapi=description["openapi"],
        info=description["info"],
        tags=description["tags"],
        operations=operations,
        schemas=schemas,
        nonce=nonce,
    )


@router.get("/docs", include_in_schema=False)
async def interface(request: Request) -> HTMLResponse:
    """The interface for people to read."""
    nonce = secrets.token_urlsafe(16)
    policy = (
        f"default-src 'none'; script-src 'nonce-{nonce}'; style-src 'unsafe-inline'; img-src data:; "
        "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )
    page = write_interface(request.app.openapi(), nonce)
    return HTMLResponse(page, headers={"Content-Security-Policy": policy})
