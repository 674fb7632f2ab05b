"""What is wrong with a region file."""

from __future__ import annotations

from planner.errors import Finding


class RegionFileError(ValueError):
    """A region file that cannot be read, or whose shapes cannot take a part in a scenario.

    Parameters
    ----------
    detail
        What is wrong.
    findings
        Each naming shape, rule and fix; never empty.
    """

    def __init__(self, detail: str, findings: tuple[Finding, ...]) -> None:
        self.findings = findings
        super().__init__(detail)


def file_error(rule: str, message: str, fix: str) -> RegionFileError:
    """An error of the file as a whole."""
    return RegionFileError(message, (Finding("file", rule, message, fix),))
