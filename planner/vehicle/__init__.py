"""Aircraft: speeds, turn radius, energy."""
