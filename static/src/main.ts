/** The page, put together. */
import "./style.css";
import { showAircraft } from "./aircraft";
import { connection, heartbeat } from "./api";
import { byId } from "./dom";
import { Drawing } from "./draw";
import { acceptDrops } from "./drop";
import { keepVehicles } from "./fleet";
import { keepFlights, refreshFlights } from "./flights";
import { boundsOf } from "./geo";
import { held, heldFeatures } from "./held";
import { buildHeader } from "./header";
import { installHook } from "./hook";
import { addLayers } from "./layers";
import { buildLegend } from "./legend";
import { createMap, fit, setData } from "./map";
import { attempt, report } from "./notices";
import { planPanel } from "./panel/plan_panel";
import { scenarioPanel } from "./panel/scenario_panel";
import { tabs } from "./panel/tabs";
import { vehiclePanel } from "./panel/vehicle_panel";
import { compared, open, openPlan, planFeatures, recent, refresh } from "./plans";
import { scenarios } from "./scenario";
import { scenarioFeatures } from "./scenario_view";
import { keepRasters } from "./terrain";
import { buildToolbar } from "./toolbar";
import type { Position } from "./types";
import { judgement, keepJudging } from "./validation";

const PLACE_ZOOM = 15;

async function start(): Promise<void> {
  const map = await createMap(byId("map"));
  addLayers(map);
  const drawing = new Drawing(map);
  const view = {
    zoomTo: (names: string[]) => fit(map, scenarios.bounds(names)),
    zoomToAll: () => fit(map, scenarios.bounds() ?? boundsOf(open.value?.plan.features ?? [])),
    zoomToPlace: (place: Position) => void map.jumpTo({ center: place, zoom: Math.max(PLACE_ZOOM, map.getZoom()) }),
  };
  buildHeader(map);
  buildToolbar(drawing);
  buildLegend(map);
  const panel = tabs([
    { id: "scenario", label: "Scenario", content: scenarioPanel(view) },
    { id: "plan", label: "Plan", content: planPanel(view) },
    { id: "fly", label: "Fly", content: vehiclePanel(() => panel.show("plan")) },
  ]);
  byId("panel").append(panel.element, ...panel.panels);
  judgement.watch(({ state, findings }) => panel.mark("scenario", state === "refused" ? `${findings.filter(({ severity }) => severity !== "warning").length} refused` : ""));
  acceptDrops(() => {
    panel.show("scenario");
    view.zoomToAll();
  });
  scenarios.document.watch((scenario) => setData(map, "scenario", scenarioFeatures(scenario)));
  open.watch((shown) => {
    setData(map, "plan", shown ? planFeatures(shown.plan) : []);
    const points = shown?.waypoints ?? [];
    setData(map, "waypoints", points.map((coordinates) => ({ type: "Feature", properties: {}, geometry: { type: "Point", coordinates } })));
  });
  held.watch((found) => setData(map, "held", found ? heldFeatures(found.items) : []));
  compared.watch((other) => setData(map, "compared", (other?.plan.features ?? []).filter((feature) => feature.properties?.["role"] === "path")));
  showAircraft(map);
  keepFlights();
  keepRasters();
  keepVehicles();
  heartbeat();
  keepJudging();
  keepListing(scenarios.restore(), () => {
    panel.suggest("plan");
    view.zoomToAll();
  });
  view.zoomToAll();
  installHook(map);
}

/** List the plans whenever the service comes up; show the newest one first unless there are edits to keep. */
function keepListing(hasEdits: boolean, shown: () => void): void {
  let settled = hasEdits;
  let before = connection.value;
  connection.watch((state) => {
    const cameUp = state === "up" && before !== "up";
    before = state;
    if (!cameUp) return;
    void attempt("The plans and flights were not listed", async () => {
      await Promise.all([refresh(), refreshFlights()]);
      const newest = recent.value.find(({ state }) => state === "done") ?? recent.value.find(({ state }) => state === "queued" || state === "running");
      if (settled || scenarios.edited.value || !newest) return;
      settled = true;
      if (await openPlan(newest.id, null, () => !scenarios.edited.value)) shown();
    });
  });
}

start().catch((error: unknown) => report("The page could not start", error));
