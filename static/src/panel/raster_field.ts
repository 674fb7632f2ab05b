/** The choice of a raster of the service: the ground a scenario lies on, or what a search is worth. */
import { button, fill, h } from "../dom";
import { attempt } from "../notices";
import type { RasterMember } from "../raster/grid";
import { scenarios } from "../scenario";
import { isOfHeights, rasters, sendRaster, type Raster } from "../terrain";
import { metres } from "../units";
import type { Field } from "./fields";

interface Kind {
  member: RasterMember;
  label: string;
  none: string;
  what: string;
  accept: string;
  title: string;
  offered(raster: Raster): boolean;
  told(raster: Raster): string;
}

const GROUND: Kind = {
  member: "terrain", label: "Ground", none: "flat, as high as home", what: "an elevation raster", accept: ".tif,.tiff,.hgt,.dt0,.dt1,.dt2,.zip", title: "GeoTIFF, DTED or SRTM HGT",
  offered: isOfHeights,
  told: (raster) => `${raster.name} (${metres(raster.min_m)} to ${metres(raster.max_m)})`,
};
const IMPORTANCE: Kind = {
  member: "importance_raster", label: "Importance raster", none: "none: the features drawn", what: "a raster of importance", accept: ".tif,.tiff,.zip", title: "GeoTIFF with the worth of seeing a square metre",
  offered: (raster) => !isOfHeights(raster),
  told: (raster) => `${raster.name} (${Number(raster.min_m.toPrecision(3))} to ${Number(raster.max_m.toPrecision(3))})`,
};

function rasterField({ member, label, none, what, accept, title, offered, told }: Kind): Field {
  const select = h("select", { id: `s-${member}` });
  const input = h("input", { type: "file", id: `${member}-file`, accept, class: "sr-only", tabindex: "-1", "aria-label": `${label}: file to send` });
  const choose = (id: string): void =>
    scenarios.change((draft) => {
      if (id === "") delete draft[member];
      else draft[member] = id;
    });
  const sync = (): void => {
    const chosen = String(scenarios.document.value[member] ?? "");
    const known = rasters.value.find(({ id }) => id === chosen);
    const listed = rasters.value.filter((raster) => offered(raster) || raster === known);
    fill(
      select,
      h("option", { value: "" }, none),
      ...listed.map((raster) => h("option", { value: raster.id }, told(raster))),
      chosen !== "" && !known ? h("option", { value: chosen }, `${chosen} (not here)`) : null,
    );
    select.value = chosen;
  };
  select.addEventListener("change", () => choose(select.value));
  input.addEventListener("change", () => {
    const file = input.files?.[0];
    input.value = "";
    if (file) void attempt(`${file.name} was not taken as ${what}`, async () => choose((await sendRaster(file, member === "importance_raster")).id));
  });
  rasters.watch(sync);
  const element = h(
    "div",
    { class: "field wide" },
    h("label", { for: `s-${member}` }, label),
    h("div", { class: "joined" }, select, button("Add raster …", () => input.click(), { title }), input),
  );
  return { element, sync };
}

export const terrainField = (): Field => rasterField(GROUND);
export const importanceField = (): Field => rasterField(IMPORTANCE);
