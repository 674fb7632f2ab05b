"""A service process whose planner is a stand-in: ``python -m tests.app.fake_server DATABASE``.

Planning processes import this module anew, so it imports nothing at its top.
"""

from __future__ import annotations

import sys


def announce(address: str) -> None:
    """Tell the address on standard output."""
    sys.stdout.write(address + "\n")
    sys.stdout.flush()


def main(database: str) -> None:
    """Serve until a signal."""
    from pathlib import Path

    from app.server import Welcome, run_server
    from app.settings import Settings
    from tests.app.conftest import pooled_house

    settings = Settings(database=Path(database), workers=1, port=0, log_level="error")
    run_server(settings, Welcome(), announce, pooled_house)


if __name__ == "__main__":
    main(sys.argv[1])
