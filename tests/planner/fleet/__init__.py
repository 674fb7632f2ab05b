"""Tests of several aircraft, and of what one of them cannot all fly to."""
