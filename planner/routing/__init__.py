"""The order of the regions and the choice among their passes."""
