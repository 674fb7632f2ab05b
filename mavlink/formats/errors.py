"""What is wrong with a mission file."""

from __future__ import annotations


class FormatError(ValueError):
    """A mission file that cannot be read.

    Parameters
    ----------
    message
        What is wrong, with the offending value.
    line
        Line of the text, counted from 1; None where the file has no lines to speak of.
    column
        Name of the column; None where there are none, or the whole line is wrong.
    """

    def __init__(self, message: str, line: int | None = None, column: str | None = None) -> None:
        self.message = message
        self.line = line
        self.column = column
        super().__init__(message if line is None else f"line {line}: {message}")
