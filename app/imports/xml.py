"""XML of strangers: no entities, no document types, nothing fetched; common slips mended."""

from __future__ import annotations

import re
from collections.abc import Iterator
from xml.etree.ElementTree import Element, ParseError
from xml.parsers.expat import ErrorString, errors

from defusedxml import DefusedXmlException
from defusedxml.ElementTree import fromstring

from app.imports.encodings import codec_of, guessed, reads
from app.imports.errors import file_error

MAX_DEPTH = 100
_DECLARATION = re.compile(r"<\?xml\b[^>]{0,200}?\?>")
_ENCODING = re.compile(rb"<\?xml\b[^>]{0,200}?\bencoding\s*=\s*[\"']([A-Za-z0-9._:/ -]{1,40})[\"']")
_NAME = re.compile(r"<[^\s<>/!?]+")
_PREFIX = re.compile(r"[<\s/]([A-Za-z_][\w.-]*):[A-Za-z_]")
_BARE_AMPERSAND = re.compile(r"&(?!(?:amp|lt|gt|quot|apos|#\d{1,7}|#x[0-9A-Fa-f]{1,6});)")
_CONTROL = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ufffe\uffff]")
_MAX_PREFIXES = 50
_UNBOUND = errors.codes[errors.XML_ERROR_UNBOUND_PREFIX]
_MENDABLE = tuple(
    errors.codes[error] for error in (errors.XML_ERROR_INVALID_TOKEN, errors.XML_ERROR_UNDEFINED_ENTITY)
)


def parse(data: bytes, notes: list[str] | None = None) -> Element:
    """The root of a document.

    Any code page that it names is read; prefixes that it binds to nothing and ampersands that stand bare are
    mended, and noted.

    Raises
    ------
    RegionFileError
        Rules ``xml-syntax``, ``xml-entities``, ``xml-depth``, ``xml-encoding``.
    """
    notes = [] if notes is None else notes
    text, lines = _text(data, notes)
    try:
        root = _parsed(text)
    except ParseError as error:
        root = _mended(text, lines, error, notes)
    level, depth = [root], 0
    while level:
        depth += 1
        if depth > MAX_DEPTH:
            raise file_error("xml-depth", "the file is nested too deeply", f"nest at most {MAX_DEPTH} levels")
        level = [child for element in level for child in element]
    return root


def _text(data: bytes, notes: list[str]) -> tuple[str, int]:
    """The text without its declaration, and how many lines went before it."""
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        codec = "utf-16"
    elif data[:2] in (b"<\x00", b"\x00<"):
        codec = "utf-16-le" if data[:1] == b"<" else "utf-16-be"
    else:
        named = _ENCODING.search(data[:1000])
        codec = _codec(named[1].decode("ascii")) if named else "utf-8"
        if codec.startswith("utf-16"):
            # bytes that are no pairs: the name is wrong
            codec = "utf-8"
        if not reads(data, codec):
            codec = guessed(data)
            notes.append(f"the file's text is not of the encoding it names and is read as {codec}")
    text = data.decode(codec, "replace").lstrip("\ufeff")
    begun = text.lstrip(" \t\r\n\x00")
    lines = text[: len(text) - len(begun)].count("\n")
    return _DECLARATION.sub("", begun, count=1) if begun.startswith("<?xml") else begun, lines


def _codec(name: str) -> str:
    codec = codec_of(name)
    if codec is None:
        raise file_error("xml-encoding", f"the encoding {name!r} is unknown", "save it as UTF-8")
    return codec


def _parsed(text: str) -> Element:
    try:
        root: Element = fromstring(text.encode("utf-8", "replace"), forbid_dtd=True)
    except DefusedXmlException as error:
        raise file_error(
            "xml-entities",
            "the file declares a document type or entities, which can hide other files",
            "save it without <!DOCTYPE>",
        ) from error
    return root


def _mended(text: str, lines: int, error: ParseError, notes: list[str]) -> Element:
    """Read again what was mended once; what still is no XML is refused where it was wrong first."""
    better = text
    if error.code in _MENDABLE:
        better = _BARE_AMPERSAND.sub("&amp;", _CONTROL.sub("", better))
    if error.code == _UNBOUND or better != text:
        better = _bound(better)
    if better != text:
        try:
            root = _parsed(better)
        except ParseError:
            pass
        else:
            notes.append("the file is no well-formed XML: bare & and prefixes bound to nothing were mended")
            return root
    line, column = error.position
    raise file_error(
        "xml-syntax",
        f"line {line + lines}, column {column + 1}: {ErrorString(error.code)}",
        "send well-formed XML",
    ) from error


def _bound(text: str) -> str:
    """The text with a declaration in its root for every prefix that has none there."""
    end = _end_of_root_name(text)
    if end is None:
        return text
    head = text[end : text.find(">", end) + 1]
    used = list(dict.fromkeys(_PREFIX.findall(text)))[:_MAX_PREFIXES]
    missing = [name for name in used if name not in ("xml", "xmlns") and f"xmlns:{name}" not in head]
    declared = "".join(f' xmlns:{name}="urn:unbound:{name}"' for name in missing)
    return text[:end] + declared + text[end:]


def _end_of_root_name(text: str) -> int | None:
    """Where the name of the first element ends, behind comments and instructions."""
    at = 0
    while True:
        at = text.find("<", at)
        closing = {"<!": "-->", "<?": "?>"}.get(text[at : at + 2]) if at >= 0 else None
        if closing is None:
            found = _NAME.match(text, at) if at >= 0 else None
            return None if found is None else found.end()
        at = text.find(closing, at)
        if at < 0:
            return None


def local_name(element: Element) -> str:
    """The tag without its namespace; other versions of a format differ in nothing else."""
    tag = element.tag
    return tag.rpartition("}")[2] if isinstance(tag, str) else ""


def child_text(element: Element, name: str) -> str:
    """The text of the first child of that name, stripped; empty where there is none."""
    for child in element:
        if local_name(child) == name:
            return (child.text or "").strip()
    return ""


def children(element: Element, *names: str) -> Iterator[Element]:
    """The children of those names."""
    return (child for child in element if local_name(child) in names)
