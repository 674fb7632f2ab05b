"""The ground station: a client of one vehicle, what it has under way, and who else is let on to the link."""
