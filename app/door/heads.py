"""Heads of HTTP/1.1 messages, as far as somebody between two ends must read them (RFC 9112)."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final

#: The end of a head; a lone line feed is taken for a line's end as well (RFC 9112, 2.2).
END: Final = re.compile(rb"\r?\n\r?\n")
MOST_BYTES: Final = 65_536

_REQUEST: Final = re.compile(rb"([!#$%&'*+.^_`|~0-9A-Za-z-]+) (\S+) HTTP/1\.([01])")
_ANSWER: Final = re.compile(rb"HTTP/1\.[01] ([1-9][0-9][0-9])(?: .*)?")
_FIELD: Final = re.compile(rb"([!#$%&'*+.^_`|~0-9A-Za-z-]+):[ \t]*(.*?)[ \t]*")
_LENGTH: Final = re.compile(rb"[0-9]{1,18}")
#: What is said of one connection, and not of the message.
_OF_THE_CONNECTION: Final = frozenset({b"connection", b"keep-alive", b"proxy-connection", b"upgrade", b"te"})

Fields = tuple[tuple[bytes, bytes], ...]


class BadHeadError(ValueError):
    """What came is no head of HTTP/1.1, or says two things about where its body ends."""


@dataclass(frozen=True, slots=True)
class RequestHead:
    """The head of a request.

    Parameters
    ----------
    path
        Without the query.
    length
        Bytes of the body; None where it comes in chunks.
    keeps
        Whether the client goes on with the same connection.
    expects
        Whether the client waits for a word before it sends the body (RFC 9110, 10.1.1).
    """

    method: bytes
    target: bytes
    path: bytes
    minor: bytes
    fields: Fields
    length: int | None
    keeps: bool
    expects: bool

    def passed_on(self) -> bytes:
        """The same for a connection that takes this one request."""
        line = b"%s %s HTTP/1.%s" % (self.method, self.target, self.minor)
        return _written(line, (*self.fields, (b"connection", b"close")))


@dataclass(frozen=True, slots=True)
class AnswerHead:
    """The head of an answer.

    Parameters
    ----------
    length
        Bytes of the body; None where it does not say.
    chunked
        Whether the body comes in chunks. Where neither is said it ends with the connection.
    """

    line: bytes
    status: int
    fields: Fields
    length: int | None
    chunked: bool

    @property
    def interim(self) -> bool:
        """Whether the answer proper is still to come."""
        return self.status < 200

    def passed_on(self, *, keeps: bool) -> bytes:
        """The same for a connection that goes on, or not."""
        return _written(self.line, self.fields if keeps else (*self.fields, (b"connection", b"close")))


def read_request(head: bytes) -> RequestHead:
    """Read the head of a request; raises BadHeadError."""
    line, fields = _read(head)
    match = _REQUEST.fullmatch(line)
    if match is None:
        raise BadHeadError("the first line is no request of HTTP/1.1")
    method, target, minor = match.groups()
    length, chunked = _framing(fields)
    asked = {word.strip().lower() for word in b",".join(_values(fields, b"connection")).split(b",")}
    path = re.sub(rb"^[a-z]+://[^/?#]*", b"", target).partition(b"?")[0] or b"/"
    return RequestHead(
        method,
        target,
        path,
        minor,
        _of_the_message(fields),
        None if chunked else length or 0,
        minor == b"1" and b"close" not in asked and not chunked,
        bool(_values(fields, b"expect")),
    )


def read_answer(head: bytes) -> AnswerHead:
    """Read the head of an answer; raises BadHeadError."""
    line, fields = _read(head)
    match = _ANSWER.fullmatch(line)
    if match is None:
        raise BadHeadError("the first line is no status of HTTP/1.1")
    length, chunked = _framing(fields)
    return AnswerHead(line, int(match[1]), _of_the_message(fields), length, chunked)


def _read(head: bytes) -> tuple[bytes, Fields]:
    line, *rest = re.split(rb"\r?\n", head)
    fields = []
    for text in rest:
        match = _FIELD.fullmatch(text)
        if match is None or b"\r" in text or b"\0" in text:
            raise BadHeadError("a header is malformed")
        fields.append((match[1].lower(), match[2]))
    return line, tuple(fields)


def _values(fields: Fields, name: bytes) -> list[bytes]:
    return [value for field, value in fields if field == name]


def _of_the_message(fields: Fields) -> Fields:
    return tuple(field for field in fields if field[0] not in _OF_THE_CONNECTION)


def _framing(fields: Fields) -> tuple[int | None, bool]:
    """Length of the body, and whether it comes in chunks."""
    lengths, codings = set(_values(fields, b"content-length")), _values(fields, b"transfer-encoding")
    if codings and (lengths or [coding.lower() for coding in codings] != [b"chunked"]):
        raise BadHeadError("where the body ends is not said clearly")
    if len(lengths) > 1 or not all(_LENGTH.fullmatch(length) for length in lengths):
        raise BadHeadError("the length of the body is not said clearly")
    return (int(lengths.pop()) if lengths else None), bool(codings)


def _written(line: bytes, fields: Fields) -> bytes:
    return b"\r\n".join([line, *(b"%s: %s" % field for field in fields), b"", b""])
