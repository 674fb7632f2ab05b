"""The command line. The commands live in the modules beside; each imports what it needs when it runs."""

from __future__ import annotations


def main() -> None:
    """Run ``swathplan``."""
    from app.cli.root import run

    run()
