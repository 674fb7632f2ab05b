"""Archives of strangers: looked through before anything is unpacked, and unpacked into memory alone."""

from __future__ import annotations

import io
import zipfile
import zlib
from collections import Counter
from pathlib import PurePosixPath

from app.imports.errors import RegionFileError, file_error

MAX_MEMBERS = 1_000
MAX_MEMBER_BYTES = 64_000_000
MAX_TOTAL_BYTES = 128_000_000
#: XML and shapefiles shrink to a tenth or so; a thousandth is a bomb.
MAX_RATIO = 200
_SMALL_BYTES = 1_000_000
_BUFFER_BYTES = 65_536


def is_zip(data: bytes) -> bool:
    """Whether the bytes begin as an archive does."""
    return data[:4] in (b"PK\x03\x04", b"PK\x05\x06")


def unpack(data: bytes, wanted: tuple[str, ...]) -> dict[str, bytes]:
    """The members whose names end in one of the wanted endings.

    Parameters
    ----------
    data
        A zip archive.
    wanted
        Endings in lower case, ``.kml``.

    Raises
    ------
    RegionFileError
        Rules ``archive-damaged``, ``archive-too-large``, ``archive-path``, ``archive-encrypted``,
        ``archive-twice``.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            members = archive.infolist()
            _judge(members)
            found: dict[str, bytes] = {}
            left = MAX_TOTAL_BYTES
            for member in members:
                if not member.is_dir() and member.filename.lower().endswith(wanted):
                    found[member.filename] = _read(archive, member, min(left, MAX_MEMBER_BYTES))
                    left -= len(found[member.filename])
            return found
    except RegionFileError:
        raise
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, OSError, ValueError) as error:
        raise file_error(
            "archive-damaged", f"the archive cannot be unpacked: {error}", "pack the files again"
        ) from error


def _judge(members: list[zipfile.ZipInfo]) -> None:
    if len(members) > MAX_MEMBERS:
        raise file_error(
            "archive-too-large", f"the archive holds {len(members)} files", f"pack at most {MAX_MEMBERS}"
        )
    for member in members:
        name = member.filename
        path = PurePosixPath(name.replace("\\", "/"))
        if path.is_absolute() or ".." in path.parts or ":" in name or "\x00" in name:
            raise file_error(
                "archive-path",
                f"the archive holds the path {name[:80]!r}, which leads out of it",
                "pack the files again, without folders",
            )
        if member.flag_bits & 0x1:
            raise file_error(
                "archive-encrypted", f"{name[:80]!r} is encrypted", "pack the files without a password"
            )
    twice = [name for name, count in Counter(member.filename for member in members).items() if count > 1]
    if twice:
        raise file_error(
            "archive-twice",
            f"the archive holds {twice[0][:80]!r} more than once, and which is meant is not known",
            "pack each file once",
        )
    total = sum(member.file_size for member in members)
    if total > MAX_TOTAL_BYTES:
        raise file_error(
            "archive-too-large",
            f"the archive unpacks to {total / 1e6:.0f} MB",
            f"keep it under {MAX_TOTAL_BYTES / 1e6:.0f} MB",
        )


def _read(archive: zipfile.ZipFile, member: zipfile.ZipInfo, limit: int) -> bytes:
    """One member; what its header says of the size is not believed."""
    pieces: list[bytes] = []
    size = 0
    with archive.open(member) as stream:
        while piece := stream.read(_BUFFER_BYTES):
            pieces.append(piece)
            size += len(piece)
            swollen = size > _SMALL_BYTES and size > MAX_RATIO * max(member.compress_size, 1)
            if size > limit or swollen:
                raise file_error(
                    "archive-too-large",
                    f"{member.filename[:80]!r} unpacks to more than {size / 1e6:.0f} MB",
                    "send the file unpacked, or a smaller one",
                )
    return b"".join(pieces)
