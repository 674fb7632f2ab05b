"""Ways to see a region with a sensor that looks to the side: strip by strip beside the line flown."""
