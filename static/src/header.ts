/** The line on top: name, whether the service answers, the background layer. */
import { connection, readiness } from "./api";
import { button, byId, fill, h } from "./dom";
import { report, warn } from "./notices";
import { rasterTemplate, setRaster } from "./map";
import type { Map as MapLibreMap } from "maplibre-gl";

const WORDS = { unknown: "connecting …", up: "service connected", down: "service not reachable, trying again …" };
/** What it answers with, but does not yet do. */
const NOT_READY = {
  starting: "service getting ready to plan: after an install it compiles for a minute or two; the page goes on by itself",
  failing: "the service can keep nothing: its database does not answer",
};

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
  const tell = (): void => {
    const state = connection.value;
    const waiting = state === "up" && (readiness.value === "starting" || readiness.value === "failing") ? readiness.value : null;
    status.dataset["state"] = waiting ?? state;
    fill(status, waiting ? NOT_READY[waiting] : WORDS[state]);
  };
  connection.watch(tell);
  readiness.watch(tell);
  fill(
    byId("top"),
    h("h1", {}, h("img", { src: "./icon.svg", alt: "" }), "Swathplan"),
    status,
    h("span", { class: "spread" }),
    background(map),
    h("a", { href: "docs", target: "_blank", rel: "noopener" }, "API"),
  );
}
