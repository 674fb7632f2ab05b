"""From messages to what is known of a vehicle: its state, its modes and events in words, its track."""
