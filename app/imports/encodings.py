"""Code pages: what files call them, and what is done where they do not, or are wrong."""

from __future__ import annotations

import codecs
import re

from app.imports.words import forbids

#: The byte 29 of a .dbf, its language driver.
_CODEC_OF_DRIVER = {
    0x01: "cp437", 0x02: "cp850", 0x03: "cp1252", 0x04: "mac_roman", 0x08: "cp865", 0x09: "cp437",
    0x0A: "cp850",
    0x0B: "cp437", 0x0D: "cp437", 0x0E: "cp850", 0x0F: "cp437", 0x10: "cp850", 0x11: "cp437", 0x12: "cp850",
    0x13: "cp932", 0x14: "cp850", 0x15: "cp437", 0x16: "cp850", 0x17: "cp865", 0x18: "cp437", 0x19: "cp437",
    0x1A: "cp850", 0x1B: "cp437", 0x1C: "cp863", 0x1D: "cp850", 0x1F: "cp852", 0x22: "cp852", 0x23: "cp852",
    0x24: "cp860", 0x25: "cp850", 0x26: "cp866", 0x37: "cp850", 0x40: "cp852", 0x4D: "gb18030", 0x4E: "cp949",
    0x4F: "cp950", 0x50: "cp874", 0x58: "cp1252", 0x59: "cp1252", 0x64: "cp852", 0x65: "cp866", 0x66: "cp865",
    0x67: "cp861", 0x6A: "cp737", 0x6B: "cp857", 0x6C: "cp863", 0x78: "cp950", 0x79: "cp949", 0x7A: "gb18030",
    0x7B: "cp932", 0x7C: "cp874", 0x7D: "cp1255", 0x7E: "cp1256", 0x86: "cp737", 0x87: "cp852", 0x88: "cp857",
    0x96: "mac_cyrillic", 0x97: "mac_latin2", 0x98: "mac_greek", 0xC8: "cp1250", 0xC9: "cp1251",
    0xCA: "cp1254",
    0xCB: "cp1253", 0xCC: "cp1257",
}  # fmt: skip
#: Names that Python does not know, or knows too narrowly: the supersets that Windows writes.
_WIDER = {
    "gbk": "gb18030", "gb2312": "gb18030", "gb18030": "gb18030", "euccn": "gb18030", "936": "gb18030",
    "54936": "gb18030", "euckr": "cp949", "ksc56011987": "cp949", "ksc5601": "cp949", "uhc": "cp949",
    "949": "cp949", "51949": "cp949", "shiftjis": "cp932", "sjis": "cp932", "xsjis": "cp932",
    "windows31j": "cp932", "mskanji": "cp932", "932": "cp932", "big5": "cp950",
    "big5hkscs": "big5hkscs", "950": "cp950", "eucjp": "euc_jp", "51932": "euc_jp", "20932": "euc_jp",
    "tis620": "cp874", "65001": "utf-8", "utf8": "utf-8", "unicode": "utf-8", "utf16": "utf-16",
    "1200": "utf-16-le", "20866": "koi8-r", "21866": "koi8-u", "20127": "ascii", "usascii": "ascii",
    "ascii": "ascii", "latin1": "iso8859-1", "latin9": "iso8859-15", "10000": "mac_roman",
    "macroman": "mac_roman", "macintosh": "mac_roman", "koi8r": "koi8-r", "koi8u": "koi8-u",
    "johab": "johab", }  # fmt: skip
#: Words that are no ASCII: of a text that names no code page these are looked at, in pieces.
_FOREIGN = re.compile(rb"[^\x00-\x20]{0,100}[\x80-\xff][^\x00-\x20]{0,100}")
_MOST_BYTES, _PIECE_BYTES, _OVERLAP_BYTES = 200_000, 10_000, 200
#: Tried in turn where nothing names the code page and the text is no UTF-8.
_CANDIDATES = (
    "gb18030", "cp932", "cp949", "cp950", "cp1251", "cp866", "cp1250", "cp1253", "cp1254", "cp1255",
    "cp1256", "cp874", "cp850", "cp852", "cp1252",
)  # fmt: skip


def codec_of(name: str) -> str | None:
    """Python's name of the code page that a file calls ``ANSI 1252``, ``8859_15``, ``GBK``, ``LDID/201``."""
    text = name.strip("\ufeff\x00 \t\r\n\"'").lower()
    driver = re.fullmatch(r"ldid/(\d{1,3})", text)
    if driver is not None:
        return _CODEC_OF_DRIVER.get(int(driver[1]))
    short = re.sub(r"[^a-z0-9]", "", text)
    if short in _WIDER:
        return _WIDER[short]
    iso = re.fullmatch(r"(?:iso)?8859(\d{1,2})(?:\d{4})?", short)
    if iso is not None and 1 <= int(iso[1]) <= 16:
        return _known(f"iso8859-{int(iso[1])}")
    page = re.fullmatch(r"(?:cp|windows|win|ansi|oem|ms|msdos|dos|ibm|codepage|x?cp)?(\d{3,5})", short)
    if page is not None:
        return _WIDER.get(page[1]) or _known(f"cp{page[1]}")
    if re.fullmatch(r"mac[a-z0-9]{2,12}|latin\d{1,2}", short):
        return _known(short if short.startswith("latin") else f"mac_{short[3:]}")
    return None


def _known(name: str) -> str | None:
    try:
        return codecs.lookup(name).name
    except LookupError:
        return None


def codec_of_driver(dbf: bytes) -> str | None:
    """The code page that a .dbf names; None for none, and for that of the machine that wrote it."""
    return _CODEC_OF_DRIVER.get(dbf[29]) if len(dbf) > 29 else None


def reads(data: bytes, codec: str) -> bool:
    """Whether all of the bytes are text of a code page."""
    try:
        data.decode(codec)
    except (UnicodeDecodeError, UnicodeError):
        return False
    return True


def guessed(data: bytes) -> str:
    """The code page of text that names none, or a wrong one.

    UTF-8 where it is that; else the first in which a word of restriction stands there, for that must not be
    missed; else that of western Windows.
    """
    if reads(data, "utf-8"):
        return "utf-8"
    foreign = b" ".join(dict.fromkeys(_FOREIGN.findall(data)))[:_MOST_BYTES]
    pieces = [foreign[at : at + _PIECE_BYTES] for at in range(0, len(foreign), _PIECE_BYTES - _OVERLAP_BYTES)]
    for codec in _CANDIDATES:
        if any(forbids(piece.decode(codec, "replace")) for piece in pieces):
            return codec
    return "cp1252"
