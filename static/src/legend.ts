/** The legend over the map: what each sign means, and a tick to hide it. */
import type { Map as MapLibreMap } from "maplibre-gl";
import { byId, fill, h } from "./dom";
import { GROUPS, showGroup } from "./layers";
import { onThemeChange, palette } from "./theme";

const NARROW_PX = 1500;

export function buildLegend(map: MapLibreMap): void {
  const hidden = new Set<string>();
  const details = h("details", { open: innerWidth > NARROW_PX });
  const draw = (): void => {
    const colours = palette();
    fill(
      details,
      h("summary", {}, "Legend"),
      ...GROUPS.map((group) =>
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
      ),
    );
  };
  draw();
  onThemeChange(draw);
  byId("legend").append(details);
}
