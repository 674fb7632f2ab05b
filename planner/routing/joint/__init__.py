"""Order, heading, offset and side chosen together: ``auto``."""
