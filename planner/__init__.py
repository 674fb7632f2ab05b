"""Plans missions for side-looking sensors: regions, threats and an aircraft in, a checked plan out."""
