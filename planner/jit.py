"""numba's ``njit``, fit for kernels that several processes compile and keep in one folder.

Every kernel takes it from here; two habits of numba's store are mended before the first is compiled.

*Names.* numba tells functions of one name apart by a number that each process counts from 1. Helpers of its
own (the sort within ``argsort``, say) that two processes compiled for different kernels then carry one
symbol, and a third that loads both kernels runs one kernel with the other's helper: it crashes
(numba/numba issue 10486). Here the numbers are drawn by chance, anew in a fork too.

*Places.* numba numbers the forms of a kernel after those in its index, and writes the index before the form:
of two processes that save at the same moment both take the same number, and what is loaded under one
signature could be the other's code. Here one process at a time reads or writes what is kept in a folder.
"""

from __future__ import annotations

import contextlib
import fcntl
import secrets
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TypeVar

import numba
from numba.core.bytecode import FunctionIdentity
from numba.core.caching import IndexDataCacheFile

#: Of a million names two are the same in one installation of ten million.
_BITS = 62

Kernel = TypeVar("Kernel", bound=Callable[..., Any])


def _mend() -> None:
    identity: Any = FunctionIdentity
    identity._unique_ids = iter(lambda: secrets.randbits(_BITS), None)

    kept: Any = IndexDataCacheFile
    save, load = kept.save, kept.load

    def save_in_turn(file: IndexDataCacheFile, key: object, data: object) -> None:
        with _locked(file):
            save(file, key, data)

    def load_in_turn(file: IndexDataCacheFile, key: object) -> object:
        with _locked(file):
            return load(file, key)

    kept.save, kept.load = save_in_turn, load_in_turn


@contextlib.contextmanager
def _locked(file: IndexDataCacheFile) -> Iterator[None]:
    with contextlib.ExitStack() as held:
        # What cannot be locked cannot be written either: an image's read-only kernels are loaded as they are.
        with contextlib.suppress(OSError):
            lock = held.enter_context(Path(file._index_path).with_name("keeping.lock").open("w"))
            fcntl.flock(lock, fcntl.LOCK_EX)
        yield


_mend()


def njit(**options: Any) -> Callable[[Kernel], Kernel]:
    """Compile a function: the options are those of ``numba.njit``."""
    decorator: Callable[[Kernel], Kernel] = numba.njit(**options)
    return decorator
