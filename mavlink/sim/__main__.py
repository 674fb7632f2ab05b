"""``python -m mavlink.sim``: a simulated aircraft on a link."""

import sys

from mavlink.sim.run import main

sys.exit(main())
