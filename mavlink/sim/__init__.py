"""A simulated aircraft: its own dynamics, guidance and vehicle side of the protocol."""
