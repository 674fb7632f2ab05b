"""Coordinates of other reference systems, brought to WGS 84."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from functools import lru_cache

from pyproj import CRS
from pyproj.database import query_crs_info
from pyproj.enums import PJType
from pyproj.exceptions import CRSError, ProjError
from pyproj.transformer import TransformerGroup
from shapely import segmentize
from shapely.geometry import LineString

from app.imports.errors import file_error
from app.imports.shapes import LonLat

#: A straight edge of a map projection is none in longitude and latitude; cut to pieces of a kilometre, it is
#: within a decimetre.
_PIECE_M = 1000.0
_MAX_PIECES = 10_000
_NAMED = re.compile(r"(EPSG|ESRI|OGC):[A-Za-z0-9]{1,12}", re.IGNORECASE)

#: ``EPSG:32632``, ``urn:ogc:def:crs:EPSG::32632``, ``http://www.opengis.net/def/crs/EPSG/0/32632``, 32632.
_WRITTEN = re.compile(
    r"(?:(?:urn:(?:x-)?ogc:def:crs:|https?://www\.opengis\.net/def/crs/)?(?P<authority>EPSG|ESRI|OGC|CRS)[:/]"
    r"(?:[0-9.]*[:/])?|https?://www\.opengis\.net/gml/srs/epsg\.xml#)?(?P<code>CRS84H?|[0-9]{2,6})",
    re.IGNORECASE,
)
_WKT = ("PROJCS[", "GEOGCS[", "PROJCRS[", "GEOGCRS[", "GEODCRS[", "BOUNDCRS[", "COMPD_CS[", "COMPOUNDCRS[")
#: Numbers beyond are Esri's.
_LAST_EPSG = 32_767

ToWgs84 = Callable[[list[LonLat]], list[LonLat]]


def named_crs(name: str) -> CRS:
    """The reference system of an authority's code, ``EPSG:32611``.

    Raises
    ------
    RegionFileError
        Rule ``crs``.
    """
    # nothing else: PROJ strings can name files
    if not _NAMED.fullmatch(name.strip()):
        raise file_error("crs", f"{name[:60]!r} is no code of a reference system", "write e.g. EPSG:32611")
    return _checked(lambda: CRS.from_user_input(name.strip()), name)


@lru_cache(maxsize=64)
def written_crs(name: str) -> CRS:
    """The reference system that a file names: a code, a URN or an address of OGC, its name, or its WKT.

    Raises
    ------
    RegionFileError
        Rule ``crs``.
    """
    text = name.strip()
    short = re.sub(r"[\s_-]", "", text).upper()
    if short in ("CRS84", "WGS84", "OGC:CRS84", "EPSG4326"):
        return CRS.from_epsg(4326)
    if short in ("EPSG:900913", "EPSG:3785", "900913", "3785", "EPSG:102100", "102100", "102113"):
        return CRS.from_epsg(3857)
    found = _WRITTEN.fullmatch(text)
    if found is not None:
        authority, code = (found["authority"] or "EPSG").upper(), found["code"].upper()
        if authority in ("OGC", "CRS") and code in ("CRS84", "84", "CRS84H"):
            return CRS.from_epsg(4326)
        if authority == "EPSG" and code.isdigit() and int(code) > _LAST_EPSG:
            return named_crs(f"ESRI:{code}")
        return named_crs(f"{authority}:{code}")
    if text.upper().startswith(_WKT):
        return crs_of_prj(text)
    return _of_name(text) or named_crs(text)


def _of_name(text: str) -> CRS | None:
    """The system that PROJ's list has by this name, ``WGS 84 / UTM zone 32N``; None where it has not one."""
    kinds = [PJType.PROJECTED_CRS, PJType.GEOGRAPHIC_2D_CRS]
    plain = text.casefold()
    found = [
        info for info in query_crs_info(auth_name="EPSG", pj_types=kinds) if info.name.casefold() == plain
    ]
    return CRS.from_epsg(int(found[0].code)) if len(found) == 1 else None


@lru_cache(maxsize=64)
def crs_of_prj(text: str) -> CRS:
    """The reference system that a ``.prj`` file describes as well-known text."""
    return _checked(lambda: CRS.from_wkt(text), "the .prj file")


def _checked(make: Callable[[], CRS], name: str) -> CRS:
    try:
        crs = make()
    except (CRSError, ValueError) as error:
        raise file_error(
            "crs",
            f"{name[:60]} names no known reference system",
            "give the right one as crs, e.g. EPSG:32611",
        ) from error
    if crs.is_compound:
        crs = crs.sub_crs_list[0]
    if not (crs.is_geographic or crs.is_projected):
        raise file_error("crs", f"{name[:60]} is no reference system of maps", "give the right one as crs")
    return crs


def mover(crs: CRS, notes: list[str]) -> ToWgs84 | None:
    """As :func:`to_wgs84`; None where the places are in WGS 84 already."""
    return None if _is_wgs84(crs) else to_wgs84(crs, notes)


@lru_cache(maxsize=64)
def _is_wgs84(crs: CRS) -> bool:
    return bool(crs == CRS.from_epsg(4326))


@lru_cache(maxsize=64)
def _group(crs: CRS) -> TransformerGroup:
    """Ways to WGS 84; to find them takes longer than to use them."""
    return TransformerGroup(crs, CRS.from_epsg(4326), always_xy=True)


def to_wgs84(crs: CRS, notes: list[str]) -> ToWgs84:
    """A function that brings the corners of a line or ring to WGS 84, edges staying where they are."""
    try:
        group = _group(crs)
        transformer = group.transformers[0]
    except (ProjError, IndexError) as error:
        raise file_error("crs", f"there is no way from {crs.name} to WGS 84", "send it in WGS 84") from error
    if not group.best_available:
        notes.append(
            f"the best transformation from {crs.name} needs a grid that is not here: "
            "places may be some metres off"
        )
    projected = crs.is_projected
    piece = _PIECE_M / (crs.axis_info[0].unit_conversion_factor if projected and crs.axis_info else 1.0)

    def move(places: list[LonLat]) -> list[LonLat]:
        if projected and len(places) > 1 and all(math.isfinite(value) for place in places for value in place):
            line = LineString(places)
            # longer ones are on no map, and would fill the memory
            if line.length <= _MAX_PIECES * piece:
                places = [(x, y) for x, y in segmentize(line, piece).coords]
        east, north = transformer.transform([p[0] for p in places], [p[1] for p in places])
        return [(float(lon), float(lat)) for lon, lat in zip(east, north, strict=True)]

    return move
