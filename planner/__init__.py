"""Plans missions for cameras and side-looking radars: regions and aircraft in, a checked plan out."""
