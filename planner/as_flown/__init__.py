"""As flown: what a flight really saw, judged by its record alone, without the stages' algorithms."""
