"""numba's ``njit``, fit for kernels that several processes compile and keep in one folder.

Every kernel takes it from here; three habits of numba's store are mended.

*Names.* numba tells functions of one name apart by a number that each process counts from 1. Helpers of its
own (the sort within ``argsort``, say) that two processes compiled for different kernels then carry one
symbol, and a third that loads both kernels runs one kernel with the other's helper: it crashes
(numba/numba issue 10486). Here the numbers are drawn by chance, anew in a fork too.

*Places.* numba numbers the forms of a kernel after those in its index, and writes the index before the form:
of two processes that save at the same moment both take the same number, and what is loaded under one
signature could be the other's code. Here one process at a time reads or writes what is kept in a folder.

*Age.* numba compiles a kernel anew when its own file has changed, but not when that of a kernel has which it
calls, or a constant that it takes from there: after an upgrade it went on as before. Here those count too.
"""

from __future__ import annotations

import contextlib
import fcntl
import hashlib
import secrets
from collections.abc import Callable, Iterator
from pathlib import Path
from types import CodeType
from typing import Any, TypeVar

import numba
from numba.core.bytecode import FunctionIdentity
from numba.core.caching import IndexDataCacheFile
from numba.core.dispatcher import Dispatcher

#: Of a million names two are the same in one installation of ten million.
_BITS = 62

Kernel = TypeVar("Kernel", bound=Callable[..., Any])


def _mend() -> None:
    identity: Any = FunctionIdentity
    identity._unique_ids = iter(lambda: secrets.randbits(_BITS), None)

    kept: Any = IndexDataCacheFile
    save, load = kept.save, kept.load

    def save_in_turn(file: IndexDataCacheFile, key: object, data: object) -> None:
        _date(file)
        with _locked(file):
            save(file, key, data)

    def load_in_turn(file: IndexDataCacheFile, key: object) -> object:
        _date(file)
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

    def compiled(function: Kernel) -> Kernel:
        kernel: Any = numba.njit(**options)(function)
        kept = getattr(kernel._cache, "_cache_file", None)
        if kept is not None:
            kept.undated = kernel.py_func
        made: Kernel = kernel
        return made

    return compiled


def _date(file: Any) -> None:
    """Have a kernel's stamp tell of all that its compiled form holds.

    When it is first asked for: all that it calls is there by then.
    """
    function = getattr(file, "undated", None)
    if function is not None:
        file.undated = None
        file._source_stamp = (file._source_stamp, _taken_by(function))


def _taken_by(function: Any) -> str:
    """A digest of what a function takes from elsewhere: kernels by their stamps, constants as they are."""
    told = []
    for name in sorted(_names(function.__code__) & set(function.__globals__)):
        value = function.__globals__[name]
        if isinstance(value, Dispatcher):
            kernel: Any = value
            file = getattr(kernel._cache, "_cache_file", None)
            if file is not None:
                _date(file)
            told.append(f"{name} {value.py_func.__code__.co_code!r} {getattr(file, '_source_stamp', None)}")
        elif isinstance(value, bool | int | float | str | tuple):
            told.append(f"{name} {value!r}")
    return hashlib.sha256("\n".join(told).encode()).hexdigest()


def _names(code: CodeType) -> set[str]:
    """Names of its module that code uses, within functions of its own too."""
    inner = [_names(each) for each in code.co_consts if isinstance(each, CodeType)]
    return set(code.co_names).union(*inner)
