"""Carries a plan to an ArduPilot or PX4 vehicle and back, and simulates such a vehicle."""
