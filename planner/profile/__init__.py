"""Heights along a line: take-off, climb limits, climbing turns, landing."""
