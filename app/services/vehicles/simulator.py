"""``python -m app.services.vehicles.simulator``: a simulated aircraft that ends with whoever started it.

Its starter holds the other end of its standard input; when that end closes, be it that the starter was
killed, the aircraft ends too.
"""

from __future__ import annotations

import os
import signal
import sys
import threading

from app.priority import go_usual
from mavlink.sim.run import main


def _end_with_the_starter() -> None:
    # Not through sys.stdin: a lock of it held here would mar the end of the process, and its last words.
    while os.read(0, 4096):
        pass
    os.kill(os.getpid(), signal.SIGTERM)


if __name__ == "__main__":
    go_usual()
    threading.Thread(target=_end_with_the_starter, daemon=True).start()
    sys.exit(main(sys.argv[1:]))
