"""Pages to print: of a plan and of a flight."""
