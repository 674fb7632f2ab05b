/** The legend over the map: what each sign means, and a tick to hide it. */
import type { Map as MapLibreMap } from "maplibre-gl";
import { byId, fill, h } from "./dom";
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
  let photos = false;
  const details = h("details", { open: innerWidth > NARROW_PX });
  const draw = (): void => {
    const colours = palette();
    fill(
      details,
      h("summary", {}, "Legend"),
      ...GROUPS.filter((group) => group.of !== "photos" || photos).flatMap((group) => [
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
  open.watch((shown) => {
    if (hasPhotos(shown) === photos) return;
    photos = !photos;
    draw();
  });
  byId("legend").append(details);
}
