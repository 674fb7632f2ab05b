"""What every command does alike: read ``-``, write results, tell messages, end with 0, 1 or 2."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable
from enum import IntEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer

if TYPE_CHECKING:
    from planner.errors import Finding


class Exit(IntEnum):
    """Exit codes."""

    OK = 0
    FAILED = 1
    BAD_INPUT = 2


Json = Annotated[bool, typer.Option("--json", help="Write results and errors as JSON.")]
Output = Annotated[
    str, typer.Option("--output", "-o", help="File to write; - is standard output.", metavar="FILE")
]


class CommandError(Exception):
    """Ends a command: what to tell, and the exit code."""

    def __init__(
        self, message: str, code: Exit = Exit.FAILED, findings: Iterable[Finding] = (), **more: Any
    ) -> None:
        self.code = code
        self.findings = tuple(findings)
        self.more = more
        super().__init__(message)


def say(message: str) -> None:
    """Tell the user something on standard error."""
    typer.echo(message, err=True)


def emit(text: str, output: str = "-") -> None:
    """Write a result; a file appears whole or not at all."""
    if not text.endswith("\n"):
        text += "\n"
    if output == "-":
        sys.stdout.write(text)
        sys.stdout.flush()
        return
    emit_bytes(text.encode(), output)


def emit_bytes(content: bytes, output: str = "-") -> None:
    """Write a result that is no text; a file appears whole or not at all."""
    if output == "-":
        sys.stdout.buffer.write(content)
        sys.stdout.buffer.flush()
        return
    target = Path(output)
    partial = target.with_name(f".{target.name}.partial")
    try:
        partial.write_bytes(content)
        partial.replace(target)
    except OSError as error:
        raise CommandError(f"{output} cannot be written: {error.strerror}") from error


def require_writable(output: str) -> None:
    """End before the work is done rather than after it when its result has nowhere to go."""
    folder = Path(output).parent
    if output == "-":
        return
    if not folder.is_dir():
        raise CommandError(f"{output} cannot be written: there is no folder {folder}")
    if Path(output).is_dir():
        raise CommandError(f"{output} cannot be written: it is a folder")


def emit_json(value: Any, output: str = "-") -> None:
    """Write a result as indented JSON."""
    emit(json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False, default=str), output)


def read_bytes(source: str) -> bytes:
    """A file's content, or standard input's for ``-``."""
    if source == "-":
        return sys.stdin.buffer.read()
    try:
        return Path(source).read_bytes()
    except OSError as error:
        raise CommandError(f"{source} cannot be read: {error.strerror}", Exit.BAD_INPUT) from error


def read_document(source: str) -> dict[str, Any]:
    """A JSON object from a file or standard input, read strictly."""
    from app.services.documents import read_object
    from app.services.errors import RefusedError

    try:
        return read_object(read_bytes(source))
    except RefusedError as error:
        name = "standard input" if source == "-" else source
        raise CommandError(f"{name} is not understood", Exit.BAD_INPUT, error.findings) from error


def fail(error: CommandError, as_json: bool) -> NoReturn:
    """Tell an error on standard error and end."""
    if as_json:
        from app.services.plans.work import finding_json

        body = {"error": str(error), "errors": [finding_json(f) for f in error.findings], **error.more}
        say(json.dumps(body, ensure_ascii=False, default=str))
    else:
        # A message that is its only finding's is said once, with rule and fix.
        if len(error.findings) == 1 and error.findings[0].message == str(error):
            say(f"error: {error.findings[0]}")
        else:
            say(f"error: {error}")
            for finding in error.findings:
                say(f"  {finding}")
    raise SystemExit(int(error.code))


class Narrator:
    """Tells progress on standard error: a line that renews itself on a terminal, else a line a stage."""

    def __init__(self) -> None:
        self._terminal = sys.stderr.isatty()
        self._stage = ""

    def __call__(self, stage: str, fraction: float) -> None:
        """Take one report."""
        if self._terminal:
            typer.echo(f"\r\033[K{fraction:4.0%} {stage}", err=True, nl=False)
        elif stage != self._stage:
            say(f"{fraction:4.0%} {stage}")
        self._stage = stage

    def end(self) -> None:
        """Leave the line."""
        if self._terminal and self._stage:
            typer.echo("\r\033[K", err=True, nl=False)
