/** What each aircraft of a plan does, with its files; and what none of them sees. */
import { isDark } from "../crew/clock";
import { coloursOf, crewOf } from "../crew/flights";
import { h, section } from "../dom";
import { pathsOf } from "../phases";
import { planUrl, type OpenPlan } from "../plans";
import { number, metres, seconds } from "../units";

const FILES = [["mission.plan", "QGC"], ["mission.waypoints", "WPL"], ["mission.kml", "KML"]] as const;

function files({ record, plan }: OpenPlan, vehicle: string): HTMLElement[] {
  const sorties = pathsOf(plan).filter(({ properties }) => properties?.["vehicle"] === vehicle).map(({ properties }) => Number(properties?.["sortie"] ?? 1));
  return sorties.flatMap((sortie) =>
    FILES.map(([file, label]) => {
      const query = `?vehicle=${encodeURIComponent(vehicle)}${sorties.length > 1 ? `&sortie=${sortie}` : ""}`;
      const words = sorties.length > 1 ? `${label} ${sortie}` : label;
      return h("a", { href: planUrl(record.id, file) + query, download: "", "aria-label": `${words} of ${vehicle}` }, words);
    }),
  );
}

/** A row for each aircraft; nothing where there is one that flies once. */
export function vehiclesTable(shown: OpenPlan): HTMLElement | null {
  const { plan } = shown;
  const crew = crewOf(plan);
  if (crew.length < 2 && pathsOf(plan).length < 2) return null;
  const colours = coloursOf(plan, isDark());
  const told = plan.metrics.vehicles ?? {};
  const energy = Object.values(told).some(({ energy_wh }) => typeof energy_wh === "number");
  const heads = ["Aircraft", "Length", "In the air", "Lands at", ...(energy ? ["Energy"] : []), "Priority"];
  return section(
    "Aircraft",
    true,
    h(
      "table",
      { class: "compare", id: "vehicles" },
      h("thead", {}, h("tr", {}, ...heads.map((label) => h("th", { scope: "col" }, label)))),
      h(
        "tbody",
        {},
        ...crew.map((name) => {
          const of = told[name];
          return h(
            "tr",
            {},
            h("th", { scope: "row", class: "crew", style: `--c:${colours.get(name) ?? "currentColor"}` }, name),
            h("td", {}, metres(of?.length_m)),
            h("td", {}, seconds(of?.duration_s)),
            h("td", {}, seconds(of?.landing_s)),
            energy ? h("td", {}, number(of?.energy_wh, 0, "Wh")) : null,
            h("td", {}, number(of?.priority, 0)),
          );
        }),
      ),
    ),
    ...crew.map((name) => h("p", { class: "crew-files", style: `--c:${colours.get(name) ?? "currentColor"}` }, h("span", {}, name), ...files(shown, name))),
  );
}

/** Regions that are not seen, why, and by how much the limit that binds would have to give. */
export function leftOut({ plan }: OpenPlan): HTMLElement | null {
  const left = plan.metrics.left_out ?? [];
  if (left.length === 0) return null;
  const margin = (value: number | null | undefined, reason: string): string => {
    if (typeof value !== "number") return "";
    const unit = reason === "energy" ? "Wh" : reason === "range" ? "m" : "s";
    return `, by ${unit === "s" ? seconds(value) : unit === "m" ? metres(value) : number(value, 0, unit)}`;
  };
  return section("Left out", true, h("ul", { class: "findings", id: "left-out" }, ...left.map((one) => h("li", { class: "warning" }, `${one.roi}: ${one.reason}${margin(one.margin, one.reason)}`))));
}
