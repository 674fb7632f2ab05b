/** The legend over the map: what each sign means, and a tick to hide it. */
import type { Map as MapLibreMap } from "maplibre-gl";
import { byId, fill, h } from "./dom";
import { flown } from "./flights";
import { GROUPS, showGroup, type Group } from "./layers";
import { watched } from "./fleet";
import { held } from "./held";
import { phaseFeatures } from "./phases";
import { compared, open } from "./plans";
import { grids } from "./raster/grid";
import { scenarios } from "./scenario";
import { scenarioFeatures } from "./scenario_view";
import { debounce, Signal } from "./signal";
import { hasPhotos } from "./survey/shots";
import { onThemeChange, palette } from "./theme";

const NARROW_PX = 1500;
const QUIET_MS = 50;
const hidden = new Set<string>(GROUPS.filter(({ asked }) => asked).map(({ id }) => id));

/** How often a tick has been set or taken away. */
export const ticks = new Signal(0);

/** Whether the operator lets a group be seen. */
export const isShown = (id: string): boolean => !hidden.has(id);

/** What the colours of a group stand for. */
function key(classes: NonNullable<Group["classes"]>): HTMLElement {
  return h("div", { class: "classes" }, ...classes.map(({ label, colour }) => h("span", {}, h("span", { class: "block", style: `--c:${colour}`, "aria-hidden": "true" }), label)));
}

const kindsOf = (features: readonly { properties: Record<string, unknown> | null }[], property: string): Set<string> => new Set(features.map(({ properties }) => String(properties?.[property] ?? "")));

/** The groups of which something is on the map. */
function present(): Set<string> {
  const kinds = kindsOf(scenarioFeatures(scenarios.document.value), "kind");
  const found = new Set([...kinds].map((kind) => (kind === "target" ? "roi" : kind)));
  if (grids.importance_raster.value) found.add("importance");
  if (grids.terrain.value) found.add("relief");
  const shown = open.value;
  if (shown) {
    const roles = kindsOf(shown.plan.features, "role");
    for (const role of ["footprint", "uncovered", "path", "collect", "fence", "rally"]) if (roles.has(role)) found.add(role);
    if (phaseFeatures(shown.plan, shown.items).length > 0) found.add("phases");
    if (shown.items.length > 0) found.add("waypoints");
    if (hasPhotos(shown)) for (const group of GROUPS) if (group.of === "photos") found.add(group.id);
    found.add("crew");
    // A mission file has no scenario, and a search chooses none.
    if (!("mission_file" in shown.plan) && shown.plan.metrics.area_seen_m2 == null) found.add("network");
  }
  if (compared.value) found.add("compared");
  if (held.value) found.add("held");
  const now = flown.value;
  if (now || watched.value?.flight_id) found.add("track").add("trackOn");
  if (now) {
    for (const role of kindsOf(now.seen.features, "role")) found.add(role);
    if (now.photos.length > 0) found.add("taken");
    if ((now.seen.photos?.assumed ?? 0) === 0) found.delete("assumed");
  }
  return found;
}

export function buildLegend(map: MapLibreMap): void {
  const details = h("details", { open: innerWidth > NARROW_PX });
  let shown = "";
  const draw = (): void => {
    const colours = palette();
    const there = present();
    shown = [...there].sort().join();
    const listed = GROUPS.filter(({ id }) => there.has(id));
    fill(
      details,
      h("summary", {}, "Legend"),
      listed.length === 0 ? h("p", { class: "quiet" }, "Nothing is on the map yet.") : null,
      ...listed.flatMap((group) => [
        h(
          "label",
          {},
          h("input", {
            type: "checkbox",
            checked: !hidden.has(group.id),
            onchange: (event: Event) => {
              const ticked = (event.target as HTMLInputElement).checked;
              if (ticked) hidden.delete(group.id);
              else hidden.add(group.id);
              showGroup(map, group, ticked);
              ticks.set(ticks.value + 1);
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
  const look = debounce(() => [...present()].sort().join() !== shown && draw(), QUIET_MS);
  for (const signal of [scenarios.document, open, compared, held, flown, grids.terrain, grids.importance_raster] as Signal<unknown>[]) signal.watch(look);
  let flight: string | null = null;
  watched.watch((vehicle) => {
    if ((vehicle?.flight_id ?? null) === flight) return;
    flight = vehicle?.flight_id ?? null;
    look();
  });
  byId("legend").append(details);
}
