/** Flights: which there were, and the ground really seen by one of them. */
import { ask } from "../dialog";
import { button, fill, h, section } from "../dom";
import { fillFrom, flights, flightUrl, flown, refly, refreshFlights, showFlight, showSortie, type Filled, type Flown } from "../flights";
import { wouldBeLost } from "../leaving";
import { attempt, news } from "../notices";
import { open, openPlan, recent } from "../plans";
import { flownPhotos } from "./flown_photos";
import { moreOf } from "./more";
import type { Flight, SeenCollection } from "../types";
import { number, percent, percentDown, seconds } from "../units";

/** Silences of the record, what counts for nothing, and what the batteries gave, in a line each. */
function doubts(seen: SeenCollection): (HTMLElement | null)[] {
  const silences = seen.gaps.map((gap) => `${new Date(gap.start_at).toLocaleTimeString()}${gap.duration_s === null ? ", until nobody knows when" : ` for ${number(gap.duration_s, 0, "s")}`}`);
  const whys = [...new Set(seen.not_counted.map((one) => one.why))];
  const length_m = seen.not_counted.reduce((sum, one) => sum + one.length_m, 0);
  const drawn = seen.energy.flatMap((one) => (one.drawn_wh === null ? [] : [one.drawn_wh]));
  const planned = seen.energy[0]?.planned_wh ?? null;
  return [
    silences.length > 0 ? h("p", { class: "warning", id: "gaps" }, `Not recorded: ${silences.slice(0, 5).join("; ")}${silences.length > 5 ? ` and ${silences.length - 5} more` : ""}. What was seen then is unknown; an onboard log may tell.`) : null,
    whys.length > 0 ? h("p", { class: "warning", id: "not-counted" }, `Sensor on, not counted, over ${number(length_m, 0, "m")}: ${whys.join("; ")}.`) : null,
    drawn.length > 0 ? h("p", { class: "quiet", id: "energy" }, `Drawn from the battery: ${number(drawn.reduce((a, b) => a + b, 0), 1, "Wh")}${planned === null ? "" : `, planned ${number(planned, 1, "Wh")}`}`) : null,
  ];
}

/** A log that the vehicle kept aboard, or another recording: what it tells of silences joins the record. */
function logField(flight: Flight): HTMLElement {
  const said = h("p", { role: "status" });
  const input = h("input", { type: "file", id: "log-file", accept: ".bin,.ulg,.tlog", class: "sr-only", tabindex: "-1", "aria-label": "Onboard log to add" });
  input.addEventListener("change", () => {
    const file = input.files?.[0];
    input.value = "";
    if (!file) return;
    fill(said, `${file.name} is being read …`);
    void attempt(`${file.name} was not added`, () => fillFrom(flight, file)).then((found) => {
      fill(said);
      if (found) news(`${file.name}: ${filledWords(found)}`);
    });
  });
  const add = button("Add an onboard log …", () => input.click(), { id: "add-log", title: "The vehicle's own log (.bin, .ulg) or another recording of its link (.tlog): fills what was not recorded" });
  return h("div", {}, h("div", { class: "row" }, add, input), said);
}

function filledWords({ filled, left, points, photos }: Filled): string {
  if (filled.length === 0 && points === 0 && photos === 0) return left.length === 0 ? "nothing was missing that it tells of." : `it fills nothing: ${left.map(({ why }) => why).join("; ")}.`;
  const stays = left.length === 0 ? "" : ` ${left.length} stay: ${[...new Set(left.map(({ why }) => why))].join("; ")}.`;
  return `${filled.length} ${filled.length === 1 ? "gap" : "gaps"} filled with ${points} places${photos > 0 ? ` and ${photos} photos` : ""}.${stays}`;
}

function flownTable(now: Flown, planned: () => void): HTMLElement {
  const { flight, seen } = now;
  const short = new Set(seen.regions.filter((region) => !region.seen).map(({ roi }) => roi));
  const least = percent(seen.seen_fraction, 1);
  const again = async (): Promise<void> => {
    const lines = [
      "A new scenario is made of what was not seen, and planned. It takes the place of the one on the page.",
      wouldBeLost() ? "The one on the page is kept nowhere else: download it first if it is still needed." : "The one on the page is kept by the service.",
      `What ${flight.vehicle_name} holds stays as it is until the new plan is uploaded.`,
    ];
    if ((await ask({ title: "Plan the gaps?", lines, go: "Plan the gaps" })) === null) return;
    const record = await attempt("The gaps were not planned", () => refly(flight.id));
    if (record && (await attempt("The plan of the gaps was not opened", () => openPlan(record.id)))) planned();
  };
  return h(
    "div",
    { class: "card", id: "flown" },
    h("p", {}, seen.flight === null ? `Ground really seen by ${seen.flights.length} flights of one plan` : `Ground really seen by ${flight.vehicle_name}`),
    flight.plan_id !== open.value?.record.id ? h("p", { class: "warning" }, "It flew another plan than the one on the map: its regions are those of that plan's scenario.") : null,
    h("p", { class: short.size > 0 ? "error" : "good" }, short.size > 0 ? `Less than ${least} seen of ${[...short].join(", ")}.` : `At least ${least} of every region was seen.`),
    h(
      "table",
      {},
      h("thead", {}, h("tr", {}, h("th", {}, "Region"), h("td", {}, "seen"), h("td", {}, "unknown"), h("td", {}, "planned"))),
      h(
        "tbody",
        {},
        ...Object.entries(seen.coverage).map(([roi, fraction]) =>
          h("tr", { class: short.has(roi) ? "short" : "" }, h("th", { scope: "row" }, roi), h("td", {}, percentDown(fraction)), h("td", {}, percent(seen.unknown_coverage[roi] ?? 0, 1)), h("td", {}, percentDown(seen.planned_coverage[roi]))),
        ),
      ),
    ),
    flownPhotos(seen.photos),
    ...doubts(seen),
    seen.flight === null ? null : button("All flights of this plan", () => void attempt("What all flights saw cannot be shown", () => showSortie(now)), { id: "sortie", class: "link" }),
    h(
      "div",
      { class: "row files" },
      button("Plan the gaps …", () => void again(), { id: "refly", class: short.size > 0 ? "primary" : "", title: "Plan a flight over what was not seen" }),
      h("a", { href: flightUrl(flight.id, "report.html"), target: "_blank", rel: "noopener" }, "Report"),
      h("a", { href: flightUrl(flight.id, "track.gpx"), download: `${flight.vehicle_name}.gpx` }, "Track (GPX)"),
      h("a", { href: flightUrl(flight.id, "track.geojson"), download: `${flight.vehicle_name}-track.geojson` }, "Track (GeoJSON)"),
      h("a", { href: flightUrl(flight.id, "coverage.geojson"), download: `${flight.vehicle_name}-coverage.geojson` }, "Coverage (GeoJSON)"),
      ...(seen.photos ? [["overlap.tif", "Overlap (GeoTIFF)"], ["gsd.tif", "Pixel sizes (GeoTIFF)"]].map(([file, label]) => h("a", { href: flightUrl(flight.id, file as string), download: `${flight.vehicle_name}-${file}` }, label as string)) : []),
    ),
    logField(flight),
    h("p", { class: "quiet" }, `Furthest from the line while the sensor was on: ${number(Math.max(0, ...seen.collects.map((c) => c.cross_track_max_m)), 1, "m")}`),
  );
}

/** Of which plan a flight was, by its name where that is known. */
function ofPlan({ plan_id }: Flight): string {
  if (plan_id === null) return "without a plan";
  return recent.value.find(({ id }) => id === plan_id)?.name ?? `plan ${plan_id.slice(0, 8)}`;
}

function lasted({ started_at, ended_at }: Flight): string {
  return ended_at === null ? "" : `, ${seconds((Date.parse(ended_at) - Date.parse(started_at)) / 1000)}`;
}

export function flightsBox(planned: () => void): HTMLElement {
  const shown = h("div", {});
  const read = async (flight: Flight): Promise<void> => {
    fill(shown, h("p", { class: "quiet", role: "status" }, "What it saw is being read …"));
    if ((await attempt("What the flight saw cannot be shown", async () => (await showFlight(flight), true))) === null) draw();
  };
  const items = moreOf(
    "flights",
    flights,
    (flight) =>
      h(
        "li",
        {},
        flight.plan_id === null
          ? h("span", {}, `${flight.vehicle_name} · ${ofPlan(flight)} · ${flight.state}`)
          : button(`${flight.vehicle_name} · ${ofPlan(flight)} · ${flight.state}`, () => void read(flight), { class: "link", "aria-current": flown.value?.flight.id === flight.id }),
        h("span", { class: "quiet" }, ` ${new Date(flight.started_at).toLocaleString()}${lasted(flight)}`),
      ),
    [flown, recent],
  );
  const draw = (): void => fill(shown, flown.value ? flownTable(flown.value, planned) : null);
  flown.watch(draw);
  let plan: string | undefined;
  open.watch((now) => {
    if (now?.record.id === plan) return;
    plan = now?.record.id;
    draw();
  });
  return section("Flights", true, shown, items, button("Refresh", () => void attempt("The flights were not listed", refreshFlights)));
}
