"""A service process whose planner is a stand-in: ``python -m tests.app.fake_server DATABASE``.

With ``apart`` behind it the links are held in a process of their own, as by ``swathplan serve``; with
``sample`` it plans a scenario by itself.

Planning processes import this module anew, so it imports nothing at its top.
"""

from __future__ import annotations

import sys


def announce(address: str) -> None:
    """Tell the address on standard output."""
    sys.stdout.write(address + "\n")
    sys.stdout.flush()


def main(database: str, *words: str) -> None:
    """Serve until a signal."""
    from pathlib import Path

    from app.server import Welcome, run_apart, run_server
    from app.settings import Settings
    from tests.app.conftest import pooled_house

    settings = Settings(database=Path(database), workers=1, request_workers=2, port=0, log_level="error")
    sample = {"features": [{}], "name": "sample", "fake": "done"} if "sample" in words else None
    run = run_apart if "apart" in words else run_server
    run(settings, Welcome(scenario=sample), announce, pooled_house)


if __name__ == "__main__":
    main(*sys.argv[1:])
