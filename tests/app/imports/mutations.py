"""Structural changes to files: parts taken out, doubled, exchanged, replaced by what does not belong."""

from __future__ import annotations

import io
import json
import random
import re
import struct
import zipfile
from typing import Any
from xml.etree import ElementTree

_ODD: tuple[Any, ...] = (
    None, [], {}, "", "x", 0, -1, 1e308, 10**30, True, [[]], [None, None], [[1, 2], [3, 4]],
    {"type": "Polygon"}, "NaN",
    [1e9, -1e9],
)  # fmt: skip
_WORDS = (
    "",
    "nan",
    "-inf",
    "1e400",
    "x",
    "8,47",
    "8 47 0",
    "🛩",
    "no fly",
    "roi",
    "-0",
    "999999999999",
    "1,2,3,4,5",
)
_NUMBERS = (-1, 0, 1, 2, 3, 5, 8, 15, 25, 31, 1000, 2**31 - 1, -(2**31))


def of_json(data: bytes, dice: random.Random) -> bytes:
    """A parsed document with some of its nodes changed."""
    document = json.loads(data)
    for _ in range(dice.randint(1, 3)):
        nodes = [(None, None), *_nodes(document)]
        holder, key = dice.choice(nodes)
        if holder is None:
            document = dice.choice([document, [document], {"features": [document]}, document])
            continue
        what = dice.choice(["odd", "odd", "delete", "double", "wrap", "swap", "rename"])
        if what == "odd":
            holder[key] = dice.choice(_ODD)
        elif what == "delete":
            del holder[key]
        elif what == "wrap":
            holder[key] = [holder[key]]
        elif what == "double" and isinstance(holder, list):
            holder.insert(key, holder[key])
        elif what == "swap":
            other, there = dice.choice(nodes)
            if other is not None and there in (other if isinstance(other, dict) else range(len(other))):
                # a copy: a node within itself has no end
                holder[key] = json.loads(json.dumps(other[there]))
        elif what == "rename" and isinstance(holder, dict):
            holder[dice.choice(["type", "coordinates", "geometry", "crs", "rings", "name"])] = holder.pop(key)
    return json.dumps(document).encode()


def _nodes(value: Any) -> list[tuple[Any, Any]]:
    found: list[tuple[Any, Any]] = []
    level = [value]
    while level:
        holder = level.pop()
        if isinstance(holder, (dict, list)):
            keys = list(holder) if isinstance(holder, dict) else range(len(holder))
            found += [(holder, key) for key in keys]
            level += [holder[key] for key in keys]
    return found


def of_xml(data: bytes, dice: random.Random) -> bytes:
    """A parsed document with some of its elements changed."""
    root = ElementTree.fromstring(data)
    for _ in range(dice.randint(1, 4)):
        elements = list(root.iter())
        one, other = dice.choice(elements), dice.choice(elements)
        what = dice.choice(["text", "words", "delete", "double", "rename", "move", "attributes", "attribute"])
        if what == "text":
            one.text = dice.choice(_WORDS)
        elif what == "words":
            words = (one.text or "").split()
            dice.shuffle(words)
            one.text = " ".join([*words[: dice.randint(0, 4)], dice.choice(_WORDS)])
        elif what == "delete" and len(one):
            one.remove(one[dice.randrange(len(one))])
        elif what == "double" and len(one):
            one.append(one[dice.randrange(len(one))])
        elif what == "rename":
            one.tag = other.tag
        elif what == "move" and len(one):
            # a copy: an element within itself has no end
            other.append(ElementTree.fromstring(ElementTree.tostring(one[dice.randrange(len(one))])))
        elif what == "attributes":
            one.attrib = dict(other.attrib)
        else:
            one.set(
                dice.choice(["srsName", "srsDimension", "lat", "lon", "name", "uom", "cs"]),
                dice.choice(_WORDS),
            )
    return ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)


def of_lines(data: bytes, dice: random.Random) -> bytes:
    """Lines and words dropped, doubled, exchanged and replaced."""
    pieces = re.split(rb"([\s,;()|]+)", data)
    for _ in range(dice.randint(1, 4)):
        at, other = dice.randrange(len(pieces)), dice.randrange(len(pieces))
        what = dice.choice(["drop", "double", "swap", "word", "end"])
        if what == "drop":
            pieces[at] = b""
        elif what == "double":
            pieces.insert(at, pieces[other])
        elif what == "swap":
            pieces[at], pieces[other] = pieces[other], pieces[at]
        elif what == "word":
            pieces[at] = dice.choice(_WORDS).encode()
        elif dice.random() < 0.2:
            del pieces[at + 1 :]
    return b"".join(pieces)


def of_shp(data: bytes, dice: random.Random) -> bytes:
    """Whole numbers and floats of the head and the records replaced."""
    found = bytearray(data)
    for _ in range(dice.randint(1, 3)):
        at = 4 * dice.randrange(8, len(found) // 4)
        if dice.random() < 0.3 and at + 8 <= len(found):
            struct.pack_into("<d", found, at, dice.choice([float("nan"), float("inf"), 1e300, 0.0, -1.0]))
        else:
            struct.pack_into(dice.choice(["<i", ">i"]), found, at, dice.choice(_NUMBERS))
    return bytes(found)


def of_zip(data: bytes, dice: random.Random) -> bytes:
    """Members dropped, renamed, exchanged and changed in themselves."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    for _ in range(dice.randint(1, 3)):
        name, other = dice.choice(list(members)), dice.choice(list(members))
        what = dice.choice(["drop", "rename", "swap", "change", "change"])
        if what == "drop" and len(members) > 1:
            del members[name]
        elif what == "rename":
            new = dice.choice(
                ["doc.kml", "a/b.shp", "__MACOSX/x.kml", "x.csv", "x.PRJ", "禁飞/x.json", "y.kmz"]
            )
            members[new] = members.pop(name)
        elif what == "swap":
            members[name], members[other] = members[other], members[name]
        elif what == "change":
            members[name] = of_any(members[name], dice)
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return buffer.getvalue()


def of_any(data: bytes, dice: random.Random) -> bytes:
    """By what the content looks like."""
    if data[:2] == b"PK":
        return of_zip(data, dice)
    if data[:4] == b"\x00\x00\x27\x0a":
        return of_shp(data, dice)
    if data[:1] == b"<":
        try:
            return of_xml(data, dice)
        except ElementTree.ParseError:
            return of_lines(data, dice)
    if data[:1] == b"{" and b"}\n{" not in data:
        try:
            return of_json(data, dice)
        except ValueError:
            return of_lines(data, dice)
    return of_lines(data, dice)
