"""``python -m app.cli`` is ``swathplan``."""

from app.cli import main

main()
