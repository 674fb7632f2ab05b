"""Text in any code page: names are read, and words that forbid are not missed."""

from __future__ import annotations

import io

import pytest
import shapefile

from app.imports import Imported, ImportOptions, RegionFileError, import_regions
from app.imports.encodings import codec_of
from tests.app.imports.samples import RING, archive_of, kml, line, placemark, polygon, shapefiles

#: Code page, its language driver, spellings of it, and a text that has it.
TABLES = (
    ("cp1252", 0x03, ("1252", "ANSI 1252", "CP1252", "windows-1252", "\ufeffcp1252\r\n"), "Grünfläche Süd"),
    ("cp437", 0x01, ("437", "OEM 437", "IBM437"), "Grünfläche"),
    ("cp850", 0x02, ("850", "OEM850"), "Ænes Gård"),
    ("cp1250", 0xC8, ("1250", "Windows 1250", "WINDOWS-1250"), "Žluťoučký kůň"),
    ("cp1251", 0xC9, ("1251", "cp-1251", "ANSI 1251", "LDID/201"), "Поле Северное"),
    ("cp866", 0x65, ("866", "OEM 866"), "Поле"),
    ("cp1253", 0xCB, ("1253",), "Χωράφι"),
    ("gb18030", 0x4D, ("936", "GBK", "ANSI 936", "GB2312", "gb18030"), "农田三号"),
    ("cp949", 0x4E, ("949", "EUC-KR", "ks_c_5601-1987"), "농지"),
    ("cp932", 0x13, ("932", "Shift_JIS", "SJIS", "Windows-31J"), "田畑ソ"),
    ("cp950", 0x78, ("950", "Big5", "BIG-5"), "農田"),
    ("utf-8", None, ("UTF-8", "utf8", "65001", "UTF_8"), "Поле 农田 Süd"),
    ("iso8859-1", None, ("8859_1", "ISO-8859-1", "ISO88591", "88591", "Latin1"), "Prés"),
    ("iso8859-15", None, ("885915", "ISO 8859-15", "latin9"), "Prés à 5 €"),
    ("koi8-r", None, ("KOI8-R", "20866"), "Поле"),
)


def table(text: str, codec: str, driver: int = 0) -> dict[str, bytes]:
    """A shapefile of one polygon with that name, the driver in its head."""
    files = shapefiles([[RING[::-1]]], ["x"])
    shp, shx, dbf = io.BytesIO(), io.BytesIO(), io.BytesIO()
    with shapefile.Writer(shp=shp, shx=shx, dbf=dbf, encoding=codec) as writer:
        writer.field("name", "C", size=60)
        writer.poly([RING[::-1]])
        writer.record(text)
    head = bytearray(dbf.getvalue())
    head[29] = driver
    return files | {".dbf": bytes(head), ".shp": shp.getvalue()}


def name_of(found: Imported) -> str:
    (account,) = found.shapes
    return account.name


@pytest.mark.parametrize(("codec", "driver", "spellings", "text"), TABLES, ids=[row[0] for row in TABLES])
def test_tables_are_of_the_code_page_they_name(
    codec: str, driver: int | None, spellings: tuple[str, ...], text: str
) -> None:
    """The driver of the .dbf counts, every spelling of a .cpg goes before it."""
    if driver is not None:
        assert name_of(import_regions(archive_of(table(text, codec, driver)))) == text
    for spelling in spellings:
        files = table(text, codec, 0x01) | {".cpg": spelling.encode()}
        assert name_of(import_regions(archive_of(files))) == text, spelling


@pytest.mark.parametrize("driver", [0x00, 0x57])
def test_a_table_that_names_none_is_looked_at(driver: int) -> None:
    """UTF-8 is known, western Windows is taken; a word that forbids is found in any code page."""
    assert name_of(import_regions(archive_of(table("Süd", "utf-8", driver)))) == "Süd"
    assert name_of(import_regions(archive_of(table("Süd", "cp1252", driver)))) == "Süd"
    for word, codec in (
        ("禁飞区", "gb18030"), ("禁飛區", "cp950"), ("비행금지구역", "cp949"), ("запретная зона", "cp1251"),
        ("飛行禁止", "cp932"), ("zakázaná oblast", "cp1250"), ("απαγορευμένη", "cp1253"),
    ):  # fmt: skip
        found = import_regions(archive_of(table(word, codec, driver)))
        assert found.shapes[0].role == "no_fly", word
    wrong = table("Süd", "cp1252", 0x03) | {".cpg": b"UTF-8"}
    assert name_of(import_regions(archive_of(wrong))) == "Süd"


@pytest.mark.parametrize(
    "name", ["utf-7", "idna", "hex", "rot13", "base64", "punycode", "System", "", "cp99999"]
)
def test_what_is_no_code_page_is_none(name: str) -> None:
    """Python's other codecs, some of which run long or decode to bytes, are none of a file's."""
    assert codec_of(name) is None


@pytest.mark.parametrize(
    ("named", "codec", "text"),
    [
        ("GBK", "gb18030", "农田"),
        ("gb2312", "gb18030", "禁飞区"),
        ("GB18030", "gb18030", "农田"),
        ("EUC-KR", "cp949", "농지"),
        ("Shift_JIS", "cp932", "田畑ソ"),
        ("Big5", "cp950", "農田"),
        ("windows-1251", "cp1251", "Поле"),
        ("ISO-8859-2", "iso8859-2", "Žluť"),
        ("KOI8-R", "koi8-r", "Поле"),
        ("UTF-16", "utf-16", "农田"),
        ("utf8", "utf-8", "农田"),
    ],
)
@pytest.mark.parametrize("ahead", ["", "\n\n  \r\n"])
def test_documents_are_of_the_encoding_they_name(named: str, codec: str, text: str, ahead: str) -> None:
    """Chinese, Korean, Japanese and other KML, blank lines ahead or not."""
    document = kml(placemark(text, polygon(RING))).decode().replace("UTF-8", named)
    assert name_of(import_regions((ahead + document).encode(codec))) == text


def test_a_document_that_names_the_wrong_encoding_is_noted() -> None:
    """Text of another code page than UTF-8 is read all the same, words that forbid found in it."""
    data = kml(placemark("禁飞区", line(RING))).decode().encode("gbk")
    found = import_regions(data)
    assert found.shapes[0].role == "no_fly"
    assert any("encoding" in note for note in found.notes)
    with pytest.raises(RegionFileError) as caught:
        import_regions(kml().replace(b"UTF-8", b"klingon"))
    assert caught.value.findings[0].rule == "xml-encoding"


TRACK = "<gx:Track><gx:coord>8 47 0</gx:coord><gx:coord>8 48 0</gx:coord></gx:Track>"
LINE = line([(8.0, 47.0), (8.0, 48.0)])


@pytest.mark.parametrize(
    "document",
    [
        f"<kml><Document><Placemark><name>x</name>{TRACK}</Placemark></Document></kml>",
        f'<kml xsi:schemaLocation="a b"><Placemark><name>x</name>{LINE}</Placemark></kml>',
        '<?xml version="1.0"?><!-- <a:b> --><kml xmlns:gx="u"><Placemark><name>x</name><atom:link href="y"/>'
        f"{LINE}</Placemark></kml>",
        f"<kml><Placemark><name>x</name><description>a & b &nbsp;</description>{LINE}</Placemark></kml>",
    ],
)
def test_slips_of_other_programs_are_mended(document: str) -> None:
    """Prefixes that nothing binds and bare ampersands are read, and the file is said to be no XML."""
    found = import_regions(document.encode(), ImportOptions(width_m=10.0))
    assert [(account.name, account.kind) for account in found.shapes] == [("x", "line")]
    assert any("well-formed" in note for note in found.notes)
