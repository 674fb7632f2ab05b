"""One process compiles the kernels; those that begin meanwhile wait for it and take what it has compiled.

numba keeps what it compiles beside the sources, or in NUMBA_CACHE_DIR, but several processes that find
nothing there compile all of it each: minutes of every core. The lock is the system's (flock): it ends with
its process.
"""

from __future__ import annotations

import contextlib
import fcntl
import hashlib
import os
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Final

import llvmlite
import numba
from llvmlite.binding import get_host_cpu_features, get_host_cpu_name

from planner.dubins.kernels import dubins_length

#: A process that holds the lock and stands still keeps others no longer; they compile for themselves.
PATIENCE_S: Final = 600.0
_LOOK_S: Final = 0.1
_ROOT: Final = Path(__file__).parent


class Compiling:
    """What is known of the kernels kept in one folder, and the turns of those that would compile them.

    Parameters
    ----------
    folder
        Where numba keeps them; None asks numba.
    patience_s
        How long to wait for another process.
    """

    def __init__(self, folder: Path | None = None, patience_s: float = PATIENCE_S) -> None:
        kernel: Any = dubins_length
        self._folder = Path(str(kernel.stats.cache_path)) if folder is None else folder
        self._patience_s = patience_s
        self._stamp = self._folder / f"compiled-{_key()}"
        self._lock = self._folder / "compiling.lock"

    @property
    def done(self) -> bool:
        """Whether somebody has compiled these sources for this processor."""
        return self._stamp.exists()

    def once(self, load: Callable[[], bool]) -> None:
        """Load kernels: at once where they are kept, else in turn.

        Parameters
        ----------
        load
            Loads what is kept and compiles what is not; says whether it has compiled anything.
        """
        if self.done and not load():
            return
        with self._turn():
            if not self.done:
                load()
                self._note()
                return
        # Another process has compiled them meanwhile: nobody has to wait while they are loaded.
        load()

    @contextlib.contextmanager
    def _turn(self) -> Iterator[None]:
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            descriptor = os.open(self._lock, os.O_RDWR | os.O_CREAT, 0o600)
        except OSError:
            # Nothing can be kept there: each process has to compile for itself.
            yield
            return
        try:
            self._wait(descriptor)
            yield
        finally:
            os.close(descriptor)

    def _wait(self, descriptor: int) -> None:
        """Return when the lock is held, when the kernels are there, or when patience is over."""
        until_s = time.monotonic() + self._patience_s
        while not self.done and time.monotonic() < until_s:
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                time.sleep(_LOOK_S)
            except OSError:
                return  # a file system without locks
            else:
                return

    def _note(self) -> None:
        """Tell others; those of other sources or processors are told no more."""
        with contextlib.suppress(OSError):
            for old in self._folder.glob("compiled-*"):
                old.unlink(missing_ok=True)
            self._stamp.touch()


def _key() -> str:
    """What kernels depend on: the sources by size and time, the processor, numba's version."""
    told = [numba.__version__, llvmlite.__version__, get_host_cpu_name(), get_host_cpu_features().flatten()]
    for source in sorted(_ROOT.rglob("*.py")):
        found = source.stat()
        told.append(f"{source.relative_to(_ROOT)} {found.st_size} {found.st_mtime_ns}")
    return hashlib.sha256("\n".join(told).encode()).hexdigest()[:16]
