"""Whether a shape is a piece of somebody's airspace by the columns of its table, whatever these say.

Sets of airspace tell their kind by numbers and codes (openAIP's ``type`` 3, the FAA's ``TYPE_CODE`` R, grids
of ceilings in feet). What no word explains may forbid: such a shape is to be asked for.

Sources: the openAIP API's airspaces (``icaoClass``, ``upperLimit``); the FAA's Class Airspace, Special Use
Airspace and UAS Facility Maps (``LOCAL_TYPE``, ``TYPE_CODE``, ``UPPER_VAL``, ``CEILING``, ``APT1_NAME``).
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Final

from app.imports.words import plain

_COLUMNS: Final = re.compile(
    r"(?:upper|lower) ?(?:limits?|val|values?|desc|uom|code|alt|altitude|unit|ref|reference)\b.*"
    r"|icao ?class|class ?icao|air ?space\w*(?: .*)?|local ?type|type ?code|lower ?upper"
    r"|apt ?\d* ?(?:name|icao|faa ?id|laanc)|laanc\w*|uasfm\w*|map ?eff|ceiling"
    r"|vertical (?:limits?|reference)|hauteur ?max\w*|notam\w*|sua ?\w*"
)


def airspace_of(properties: Mapping[str, str], ours: frozenset[str]) -> str | None:
    """The column that says so; None where none does. Values of ours are none of its columns."""
    return next(
        (
            key
            for key, value in properties.items()
            if key not in ours and value.strip() and _COLUMNS.fullmatch(plain(key))
        ),
        None,
    )
