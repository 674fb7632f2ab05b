"""Plans: asked for, made in worker processes, and turned into missions."""
