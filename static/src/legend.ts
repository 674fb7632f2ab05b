/** The legend over the map: what each sign means, and a tick to hide it. */
import type { Map as MapLibreMap } from "maplibre-gl";
import { byId, fill, h } from "./dom";
import { flown } from "./flights";
import { GROUPS, showGroup, type Group } from "./layers";
import { open } from "./plans";
import { hasPhotos } from "./survey/shots";
import { onThemeChange, palette } from "./theme";

const NARROW_PX = 1500;
const hidden = new Set<string>();

/** Whether the operator lets a group be seen. */
export const isShown = (id: string): boolean => !hidden.has(id);

/** What the colours of a group stand for. */
function key(classes: NonNullable<Group["classes"]>): HTMLElement {
  return h("div", { class: "classes" }, ...classes.map(({ label, colour }) => h("span", {}, h("span", { class: "block", style: `--c:${colour}`, "aria-hidden": "true" }), label)));
}

export function buildLegend(map: MapLibreMap): void {
  const there = { photos: false, taken: false };
  const details = h("details", { open: innerWidth > NARROW_PX });
  const draw = (): void => {
    const colours = palette();
    fill(
      details,
      h("summary", {}, "Legend"),
      ...GROUPS.filter(({ of }) => of === undefined || there[of]).flatMap((group) => [
        h(
          "label",
          {},
          h("input", {
            type: "checkbox",
            checked: !hidden.has(group.id),
            onchange: (event: Event) => {
              const shown = (event.target as HTMLInputElement).checked;
              if (shown) hidden.delete(group.id);
              else hidden.add(group.id);
              showGroup(map, group, shown);
            },
          }),
          h("span", { class: `swatch ${group.swatch}`, style: `--c:${colours[group.colour]}`, "aria-hidden": "true" }),
          group.label,
        ),
        group.classes ? key(group.classes) : null,
      ]),
    );
  };
  draw();
  onThemeChange(draw);
  const note = (of: keyof typeof there, now: boolean): void => {
    if (there[of] === now) return;
    there[of] = now;
    draw();
  };
  open.watch((shown) => note("photos", hasPhotos(shown)));
  flown.watch((now) => note("taken", (now?.photos.length ?? 0) > 0 || (now?.seen.photos?.assumed ?? 0) > 0));
  byId("legend").append(details);
}
