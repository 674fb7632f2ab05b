/** The mission's items in a list: number, what it does, height, distance; the one being flown stands out. */
import { button, fill, h, section } from "../dom";
import { watched } from "../fleet";
import { open } from "../plans";
import type { Position } from "../types";
import { metres } from "../units";

const MOST_SHOWN = 1000;

export function waypointList(zoomTo: (place: Position) => void): HTMLElement {
  const box = h("div", { class: "items" });
  const head = section("Mission items", false, h("p", { class: "quiet" }, "Numbers as the vehicle counts them, for Go to item; ArduPilot counts home as item 0. Distances are straight from the place before; turns are flown round."), box);
  const title = head.querySelector("summary");
  let rows = new Map<number, HTMLElement>();
  const mark = (): void => {
    const vehicle = watched.value;
    const flown = vehicle?.flight_id && (vehicle.sent?.plan_id ?? vehicle.plan_id) === open.value?.record.id ? vehicle.state.mission_current : null;
    for (const [seq, row] of rows) {
      if (seq === flown) row.setAttribute("aria-current", "step");
      else row.removeAttribute("aria-current");
    }
  };
  open.watch((shown) => {
    head.hidden = shown === null;
    const items = shown?.items ?? [];
    if (title) title.textContent = `Mission items (${items.length}${items[0]?.seq === 1 ? ", and home" : ""})`;
    rows = new Map();
    fill(
      box,
      items.length === 0 ? h("p", { class: "quiet" }, "This plan cannot be said as a mission; see the notice.") : null,
      h(
        "table",
        { class: "compare waypoints" },
        h("thead", {}, h("tr", {}, ...["No.", "What", "Height", "Leg"].map((label) => h("th", { scope: "col" }, label)))),
        h(
          "tbody",
          {},
          ...items.slice(0, MOST_SHOWN).map((item) => {
            const { at } = item;
            const row = h(
              "tr",
              {},
              h("td", {}, item.seq),
              h("td", { class: "what" }, at ? button(item.what, () => zoomTo(at), { class: "link", title: `${at[1].toFixed(6)}, ${at[0].toFixed(6)}: show on the map` }) : item.what),
              h("td", {}, item.height_m === null ? "" : `${item.height_m.toFixed(0)} m ${item.over}`),
              h("td", {}, item.leg_m === null ? "" : metres(item.leg_m)),
            );
            rows.set(item.seq, row);
            return row;
          }),
        ),
      ),
      items.length > MOST_SHOWN ? h("p", { class: "quiet" }, `and ${items.length - MOST_SHOWN} more; the files have them all.`) : null,
    );
    mark();
  });
  watched.watch(mark);
  return head;
}
