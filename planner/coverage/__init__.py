"""From regions to the passes that see them."""
