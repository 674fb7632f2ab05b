"""What planning processes begin with: loaded by the import, in the process that they are forked from."""

from __future__ import annotations

from app.services.plans import work

work.initialise()
