/** How the mission of the plan on the map ends, and where that is changed. */
import { button, fill, h } from "../dom";
import type { MissionItem } from "../mission";
import { open } from "../plans";

const LANDS = new Set([21, 23, 85]);
const RETURNS = 20;
const CIRCLES = 17;

/** As its items have it, whatever was asked for. */
export function endOf(items: MissionItem[]): string {
  const last = [...items].reverse().find(({ command }) => LANDS.has(command) || command === RETURNS || command === CIRCLES);
  if (!last) return "with its last waypoint: what the aircraft does then is its firmware's choice";
  if (last.command === RETURNS) return "with a return to launch";
  return last.command === CIRCLES ? "circling at its end until told otherwise" : "with a landing";
}

export function endBox(edit: () => void): HTMLElement {
  const words = h("span", {});
  const box = h("p", { id: "mission-end" }, words, " ", button("Change …", edit, { class: "link", title: "Scenario, Aircraft: how its mission ends; then plan again" }));
  open.watch((shown) => {
    box.hidden = !shown || shown.items.length === 0;
    fill(words, `The mission ends ${endOf(shown?.items ?? [])}.`);
  });
  return box;
}
