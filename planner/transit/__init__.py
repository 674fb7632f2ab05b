"""One pose to the next round zones and threats."""
