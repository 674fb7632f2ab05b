"""The orienteering form: the most reward within a limit, and home again."""
