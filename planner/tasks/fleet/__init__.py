"""The task ``collect`` for several aircraft, sorties, windows and visits apart."""
