/** The line on top: name, whether the service answers, the background layer. */
import { connection } from "./api";
import { button, byId, fill, h } from "./dom";
import { report, warn } from "./notices";
import { rasterTemplate, setRaster } from "./map";
import type { Map as MapLibreMap } from "maplibre-gl";

const WORDS = { unknown: "connecting …", up: "service connected", down: "service not reachable, trying again …" };

function background(map: MapLibreMap): HTMLElement {
  const address = h("input", { id: "raster", type: "url", placeholder: "https://…/{z}/{x}/{y}.png", value: rasterTemplate() });
  const dialog = h(
    "dialog",
    { "aria-label": "Background tiles" },
    h("p", {}, "Raster tiles under the map, from an address with {z}, {x} and {y}. They are fetched by this browser; without an address the page needs no network."),
    h("label", { for: "raster" }, "Tile address"),
    address,
    h(
      "div",
      { class: "row" },
      button("Use", () => {
        const template = address.value.trim();
        if (template && !["{z}", "{x}", "{y}"].every((part) => template.includes(part))) return warn("The tile address lacks {z}, {x} or {y}");
        try {
          setRaster(map, template);
          dialog.close();
        } catch (error) {
          report("The background was not changed", error);
        }
      }),
      button("None", () => {
        address.value = "";
        setRaster(map, "");
        dialog.close();
      }),
      button("Cancel", () => dialog.close()),
    ),
  );
  document.body.append(dialog);
  return button("Background …", () => dialog.showModal());
}

export function buildHeader(map: MapLibreMap): void {
  const status = h("span", { class: "status", id: "service", role: "status" });
  connection.watch((state) => {
    status.dataset["state"] = state;
    fill(status, WORDS[state]);
  });
  fill(
    byId("top"),
    h("h1", {}, h("img", { src: "./icon.svg", alt: "" }), "Swathplan"),
    status,
    h("span", { class: "spread" }),
    background(map),
    h("a", { href: "docs", target: "_blank", rel: "noopener" }, "API"),
  );
}
