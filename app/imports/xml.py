"""XML of strangers: no entities, no document types, nothing fetched."""

from __future__ import annotations

from collections.abc import Iterator
from xml.etree.ElementTree import Element, ParseError
from xml.parsers.expat import ErrorString

from defusedxml import DefusedXmlException
from defusedxml.ElementTree import fromstring

from app.imports.errors import file_error

MAX_DEPTH = 100


def parse(data: bytes) -> Element:
    """The root of a document.

    Raises
    ------
    RegionFileError
        Rules ``xml-syntax``, ``xml-entities``, ``xml-depth``.
    """
    try:
        root: Element = fromstring(data, forbid_dtd=True)
    except DefusedXmlException as error:
        raise file_error(
            "xml-entities",
            "the file declares a document type or entities, which can hide other files",
            "save it without <!DOCTYPE>",
        ) from error
    except ParseError as error:
        line, column = error.position
        raise file_error(
            "xml-syntax",
            f"line {line}, column {column + 1}: {ErrorString(error.code)}",
            "send well-formed XML",
        ) from error
    except (LookupError, ValueError) as error:
        raise file_error("xml-encoding", f"the encoding is unknown: {error}", "save it as UTF-8") from error
    level, depth = [root], 0
    while level:
        depth += 1
        if depth > MAX_DEPTH:
            raise file_error("xml-depth", "the file is nested too deeply", f"nest at most {MAX_DEPTH} levels")
        level = [child for element in level for child in element]
    return root


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
