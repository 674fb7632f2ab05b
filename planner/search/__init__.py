"""See as much ground, or as much importance, as the energy allows, and end at the end."""
