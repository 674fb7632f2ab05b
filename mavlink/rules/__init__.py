"""Rules on a vehicle's parameters: what they are made of, those of flight, those of each autopilot."""
