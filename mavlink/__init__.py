"""Carries a plan to an ArduPilot or PX4 vehicle and back: items, dialects, files, transfers, links, a simulated aircraft."""
