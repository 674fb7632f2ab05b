"""Keys that the commands sign with."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mavlink.wire.signing import Signing


def signing_here(url: str, name: str = "") -> Signing | None:
    """What a command signs with: the key of a vehicle, or of all, as the service finds it; None without one.

    What the built-in simulator flies, and a recording, is not signed with it.
    """
    from app.services.vehicles.keys import COMMAND_LINK, KeyRing
    from app.settings import Settings

    if url.startswith(("sim:", "replay:")):
        return None
    return KeyRing(Settings().signing_keys, None, os.environ).signing_of(name, "", COMMAND_LINK)


def signing_in(file: Path, name: str = "") -> Signing | None:
    """The same by the keys of one file alone; None where it has none of that name, and none of all."""
    from app.services.vehicles.keys import COMMAND_LINK, KeyRing

    return KeyRing(file, None, {}).signing_of(name, "", COMMAND_LINK)
