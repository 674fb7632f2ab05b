"""Mission files: .plan, .waypoints, KML."""
