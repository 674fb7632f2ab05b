"""How cameras see regions: lanes of photos that overlap, and the patterns made of them."""
