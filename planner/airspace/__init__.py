"""Where one may fly: area, zones, obstacles, threats and their risk, terrain, wind."""
