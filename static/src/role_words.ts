/** What the roles of a scenario's features are called. */
export const ROLE_WORDS: Record<string, string> = {
  roi: "Region of interest",
  threat: "Threat",
  no_fly: "No-fly zone",
  obstacle: "Obstacle",
  area: "Operating area",
  start: "Start",
  end: "End",
  base: "Base",
  importance: "Importance",
};
