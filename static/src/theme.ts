/** Colours of the map in light and dark; the page's own colours are in style.css. */

export interface Palette {
  water: string;
  land: string;
  coast: string;
  grid: string;
  text: string;
  halo: string;
  roi: string;
  missile: string;
  radar: string;
  noFly: string;
  obstacle: string;
  area: string;
  terminal: string;
  importance: string;
  path: string;
  phase: string;
  collect: string;
  segment: string;
  photo: string;
  held: string;
  footprint: string;
  uncovered: string;
  track: string;
  trackOn: string;
  seen: string;
}

const LIGHT: Palette = {
  water: "#dbe6ec",
  land: "#f6f4ee",
  coast: "#8fa3ad",
  grid: "#c4cdd1",
  text: "#1c2529",
  halo: "#ffffff",
  roi: "#1b6fc2",
  missile: "#c62f2f",
  radar: "#b06a00",
  noFly: "#8a1c5c",
  obstacle: "#5d5046",
  area: "#4a5960",
  terminal: "#1f7a3a",
  importance: "#7a6a00",
  path: "#26323a",
  phase: "#8a4b00",
  collect: "#008f7a",
  segment: "#d2691e",
  photo: "#3d4fb8",
  held: "#d08a00",
  footprint: "#00a892",
  uncovered: "#e0361f",
  track: "#7b3fd1",
  trackOn: "#e4007c",
  seen: "#b03bd1",
};

const DARK: Palette = {
  water: "#10181c",
  land: "#1c262b",
  coast: "#51646d",
  grid: "#33424a",
  text: "#e8eef1",
  halo: "#0c1215",
  roi: "#6ab2ff",
  missile: "#ff6b60",
  radar: "#ffb04a",
  noFly: "#f27cc0",
  obstacle: "#c2ae9c",
  area: "#9fb2bb",
  terminal: "#6fdc8c",
  importance: "#e0cf4e",
  path: "#dfe8ec",
  phase: "#ffb46b",
  collect: "#2fe0c4",
  segment: "#ff9f5a",
  photo: "#a9b6ff",
  held: "#ffd166",
  footprint: "#2fe0c4",
  uncovered: "#ff7a5c",
  track: "#bb93ff",
  trackOn: "#ff5fb4",
  seen: "#d98bff",
};

const dark = matchMedia("(prefers-color-scheme: dark)");

export function palette(): Palette {
  return dark.matches ? DARK : LIGHT;
}

export function onThemeChange(listener: () => void): void {
  dark.addEventListener("change", listener);
}
