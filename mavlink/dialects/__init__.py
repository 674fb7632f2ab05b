"""What ArduPilot and PX4 accept, alter and refuse."""
