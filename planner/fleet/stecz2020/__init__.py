"""The assignment of W. Stecz and K. Gromada, Sensors 20 (2020) 5712, section 4.1: equations (19) to (33)."""
