"""Search and rescue: where the missing may be, what looks find, lines flown for it."""
