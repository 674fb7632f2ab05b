/** The choice of the ground a scenario lies on: flat, or an elevation raster of the service. */
import { button, fill, h } from "../dom";
import { attempt } from "../notices";
import { scenarios } from "../scenario";
import { rasters, sendRaster } from "../terrain";
import { metres } from "../units";
import type { Field } from "./fields";

const FLAT = "flat, as high as home";

export function terrainField(): Field {
  const select = h("select", { id: "s-terrain" });
  const input = h("input", { type: "file", id: "terrain-file", accept: ".tif,.tiff,.hgt,.dt0,.dt1,.dt2,.zip", class: "sr-only", tabindex: "-1", "aria-label": "Elevation raster to send" });
  const choose = (id: string): void =>
    scenarios.change((draft) => {
      if (id === "") delete draft["terrain"];
      else draft["terrain"] = id;
    });
  const sync = (): void => {
    const chosen = String(scenarios.document.value["terrain"] ?? "");
    const known = rasters.value.some(({ id }) => id === chosen);
    fill(
      select,
      h("option", { value: "" }, FLAT),
      ...rasters.value.map((r) => h("option", { value: r.id }, `${r.name} (${metres(r.min_m)} to ${metres(r.max_m)})`)),
      chosen !== "" && !known ? h("option", { value: chosen }, `${chosen} (not here)`) : null,
    );
    select.value = chosen;
  };
  select.addEventListener("change", () => choose(select.value));
  input.addEventListener("change", () => {
    const file = input.files?.[0];
    input.value = "";
    if (file) void attempt(`${file.name} was not taken as an elevation raster`, async () => choose((await sendRaster(file)).id));
  });
  rasters.watch(sync);
  const element = h(
    "div",
    { class: "field wide" },
    h("label", { for: "s-terrain" }, "Ground"),
    h("div", { class: "joined" }, select, button("Add raster …", () => input.click(), { title: "GeoTIFF, DTED or SRTM HGT" }), input),
  );
  return { element, sync };
}
