/** What a camera's flight took: photos, those that are missing, overlaps and pixels really reached. */
import { h } from "../dom";
import { groundWords } from "../survey/readout";
import type { SeenPhotos } from "../types";
import { percent, percentDown } from "../units";

const REASONS: Record<string, string> = { "attitude-unknown": "without an attitude", "height-unknown": "without a height", turned: "turned away" };

function count({ taken, counted, not_counted, assumed, passes }: SeenPhotos): HTMLElement[] {
  const planned = passes.reduce((sum, pass) => sum + pass.planned, 0);
  const missing = passes.filter((pass) => pass.missing > 0);
  const doubts = Object.entries(not_counted).map(([reason, number]) => `${number} ${REASONS[reason] ?? reason}`);
  const lost = missing.reduce((sum, pass) => sum + pass.missing, 0);
  const words = [`${taken} photos reported of ${planned} planned, ${counted} counted`, ...doubts].join(", ");
  return [
    h("p", { class: lost > 0 ? "error" : "good", id: "photos-taken" }, `${words}.${lost > 0 ? ` ${lost} missing, in ${missing.length === 1 ? "pass" : "passes"} ${missing.map(({ seq }) => seq).join(", ")}.` : ""}`),
    ...(assumed > 0 ? [h("p", { class: "warning" }, `The autopilot reported no photos: ${assumed} are assumed where they were planned along the line as flown. They prove nothing.`)] : []),
  ];
}

/** Null where no camera was planned. */
export function flownPhotos(photos: SeenPhotos | null | undefined): HTMLElement | null {
  if (!photos) return null;
  const gsd = (value: number | null): string => (value === null ? "–" : groundWords(value));
  return h(
    "div",
    {},
    ...count(photos),
    h(
      "table",
      { class: "narrow", id: "flown-overlap" },
      h("thead", {}, h("tr", {}, ...["Region", "A pixel, worst", "Least forward", "Least side", "In enough photos"].map((label) => h("th", { scope: "col" }, label)))),
      h(
        "tbody",
        {},
        ...photos.regions.map((region) =>
          h(
            "tr",
            {},
            h("th", { scope: "row" }, region.roi),
            h("td", { class: region.gsd_limit_m !== null && region.gsd_worst_m !== null && region.gsd_worst_m > 1.02 * region.gsd_limit_m ? "error" : "" }, gsd(region.gsd_worst_m)),
            h("td", {}, percent(region.forward_overlap.least, 0)),
            h("td", {}, percent(region.side_overlap.least, 0)),
            h("td", { title: `At least ${region.overlap_photos}; as planned ${percentDown(region.planned_overlap_fraction)}` }, percentDown(region.overlap_fraction)),
          ),
        ),
      ),
    ),
  );
}
