"""The files of the web map, with what a browser may do on its page."""

from __future__ import annotations

import os
from typing import Any, Final

from starlette.responses import Response
from starlette.staticfiles import StaticFiles

#: Scripts are the service's own. Raster tiles come from wherever the operator's address for them says, so
#: pictures may come from anywhere. The map's worker and its textures are made by the page itself.
POLICY: Final = (
    "default-src 'none'; script-src 'self'; worker-src 'self' blob:; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data: blob: http: https:; connect-src 'self' http: https:; font-src 'self'; "
    "manifest-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
#: Tile servers ask who shows their tiles: they are told the origin, and no more.
HEADERS: Final = {
    "Content-Security-Policy": POLICY,
    "Referrer-Policy": "strict-origin-when-cross-origin",
}


class MapFiles(StaticFiles):
    """Static files that bring the page's policy."""

    def file_response(self, full_path: os.PathLike[str] | str, *others: Any, **named: Any) -> Response:
        """A file, or that it has not changed."""
        answer = super().file_response(full_path, *others, **named)
        answer.headers.update(HEADERS)
        return answer
