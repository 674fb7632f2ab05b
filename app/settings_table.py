"""The table of docs/settings.md, made from the settings: ``python -m app.settings_table``."""

from __future__ import annotations

import sys
from types import NoneType
from typing import Any, Literal, get_args, get_origin

import annotated_types
from pydantic.fields import FieldInfo

from app.settings import PREFIX, Settings

_FLAGS = {"host": "--host", "port": "--port", "database": "--database", "workers": "--workers"}
_UNITS = {"_s": "s", "_bytes": "bytes"}


def _values(field: FieldInfo) -> str:
    """What may be given, with the range."""
    kind: Any = field.annotation
    if get_origin(kind) is Literal:
        return ", ".join(f"`{choice}`" for choice in get_args(kind))
    kinds = [part for part in get_args(kind) or (kind,) if part not in (NoneType, Ellipsis)]
    words = {
        "int": "whole number",
        "float": "number",
        "bool": "`true`, `false`",
        "str": "text",
        "Path": "path",
    }
    said = "list" if get_origin(kind) is tuple else words[kinds[0].__name__]
    limits = []
    for rule in field.metadata:
        match rule:
            case annotated_types.Ge(ge=limit):
                limits.append(f"at least {limit}")
            case annotated_types.Gt(gt=limit):
                limits.append(f"above {limit}")
            case annotated_types.Le(le=limit):
                limits.append(f"at most {limit}")
    return ", ".join([said, *limits])


def _default(field: FieldInfo) -> str:
    if field.default_factory is not None or field.default is None:
        return "unset"
    if field.default == ():
        return "none"
    if isinstance(field.default, tuple):
        return f"`{','.join(field.default)}`"
    return f"`{str(field.default).lower() if isinstance(field.default, bool) else field.default}`"


def table() -> str:
    """A Markdown table with a line for each setting."""
    lines = [
        "| environment variable | option of `serve` | default | unit | values | meaning |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    for name, field in Settings.model_fields.items():
        unit = next((unit for ending, unit in _UNITS.items() if name.endswith(ending)), "")
        flag = f"`{_FLAGS[name]}`" if name in _FLAGS else ""
        cells = (
            f"`{PREFIX}{name.upper()}`",
            flag,
            _default(field),
            unit,
            _values(field),
            field.description or "",
        )
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    sys.stdout.write(table())
