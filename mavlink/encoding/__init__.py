"""The parts of a mission: fence, stops along the path, both ends."""
