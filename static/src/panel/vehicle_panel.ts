/** The flying side of the panel: vehicles, upload, commands, live figures, flights. */
import { fill, h } from "../dom";
import { watched } from "../fleet";
import { flightChart } from "./chart";
import { commands } from "./commands";
import { fleetUploadBox } from "./fleet_upload_box";
import { flightsBox } from "./flights_box";
import { gauges, kindOf, words } from "./gauges";
import { holdingBox } from "./holding_box";
import { orderedBox } from "./ordered_box";
import { uploadBox } from "./upload_box";
import { vehicleList } from "./vehicle_list";
import { waypointList } from "./waypoint_list";
import type { PlanView } from "./plan_panel";

/** `planned` is called when a plan of a flight's gaps is on the map; `edit` leads to the scenario's aircraft. */
export function vehiclePanel(view: PlanView, planned: () => void, edit: () => void): HTMLElement {
  const title = h("h2", { class: "name" });
  const kind = h("span", { class: "quiet" });
  const name = h("span", {});
  fill(title, name, " ", kind);
  watched.watch((vehicle) => {
    fill(name, vehicle ? vehicle.name : "No vehicle");
    fill(kind, vehicle ? kindOf(vehicle) : "");
  });
  const upload = uploadBox(edit);
  return h("div", {}, vehicleList(), title, gauges(), upload.controls, fleetUploadBox(), commands(), orderedBox(), words(), upload.answers, flightChart(), waypointList(view.zoomToPlace), holdingBox(), flightsBox(planned));
}
