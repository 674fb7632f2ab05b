/** The page, put together. */
import "./style.css";
import { showAircraft } from "./aircraft";
import { keepAirframes } from "./airframes";
import { connection, heartbeat } from "./api";
import { keepCameras } from "./cameras";
import { byId } from "./dom";
import { Drawing } from "./draw";
import { acceptDrops } from "./drop";
import { isDark, showCrew } from "./crew/clock";
import { encoding } from "./encoding";
import { keepVehicles, watched } from "./fleet";
import { keepFlights, refreshFlights } from "./flights";
import { freshness, keepFresh } from "./freshness";
import { boundsOf } from "./geo";
import { held, heldFeatures } from "./held";
import { buildHeader } from "./header";
import { installHook } from "./hook";
import { keepScenarios } from "./keeping";
import { addLayers } from "./layers";
import { buildLegend, isShown } from "./legend";
import { createMap, fit, setData } from "./map";
import { itemFeatures } from "./mission";
import { showNetwork } from "./network";
import { attempt, clearNotices, report } from "./notices";
import { openNewest } from "./newest";
import { keepOrdered } from "./ordered";
import { planPanel } from "./panel/plan_panel";
import { scenarioPanel } from "./panel/scenario_panel";
import { buildStatusStrip } from "./panel/status_strip";
import { tabs } from "./panel/tabs";
import { vehiclePanel } from "./panel/vehicle_panel";
import { phaseFeatures } from "./phases";
import { coming, compared, keepOpenFresh, keepToTheScenario, open, openPlan, planFeatures, recent, refresh, rereadItems } from "./plans";
import { keepGrids } from "./raster/grid";
import { showRasters } from "./raster/view";
import { scenarios } from "./scenario";
import { scenarioFeatures } from "./scenario_view";
import { showRemains } from "./search/view";
import { keepSession, restore } from "./session";
import { keepRasters } from "./terrain";
import { showCursor } from "./survey/cursor";
import { keepProfile } from "./survey/profile";
import { showReadout } from "./survey/readout";
import { showSurvey } from "./survey/view";
import { onThemeChange, palette } from "./theme";
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
  const panel = tabs([
    { id: "scenario", label: "Scenario", content: scenarioPanel(view) },
    { id: "plan", label: "Plan", content: planPanel(view) },
    { id: "fly", label: "Fly", content: vehiclePanel(view, () => panel.show("plan"), () => panel.show("scenario")) },
  ]);
  buildHeader(map);
  buildStatusStrip();
  buildToolbar(drawing, () => panel.show("scenario"));
  buildLegend(map);
  byId("panel").append(panel.element, ...panel.panels);
  // Geometry is changed where the scenario is, and nowhere else.
  panel.shown.watch((id) => drawing.locked.set(id !== "scenario"));
  judgement.watch(({ state, findings }) => panel.mark("scenario", state === "refused" ? `${findings.filter(({ severity }) => severity !== "warning").length} refused` : ""));
  freshness.watch(({ state }) => panel.mark("plan", state === "stale" ? "out of date" : ""));
  acceptDrops((opened) => {
    panel.show(opened);
    view.zoomToAll();
  });
  draw(map);
  keepProfile();
  showSurvey(map, () => isShown("overlap"));
  showReadout(map);
  showNetwork(map);
  showCursor(map);
  showCrew(map, () => palette().collect);
  showRemains(map, () => isShown("remains"));
  showRasters(map, isShown);
  keepToTheScenario();
  keepScenarios();
  keepFresh();
  keepOpenFresh();
  scenarios.replaced.watch(clearNotices);
  encoding.watch(() => void rereadItems());
  showAircraft(map);
  keepFlights();
  keepRasters();
  keepGrids();
  keepCameras();
  keepAirframes();
  keepVehicles();
  keepOrdered();
  heartbeat();
  keepJudging();
  const before = restore();
  // Who reloads in flight goes on watching, with geometry locked.
  if (before?.panel) panel.show(before.panel);
  coming.set(before?.plan ?? null);
  keepSession(panel.shown);
  keepListing(before, () => {
    panel.suggest("plan");
    view.zoomToAll();
  });
  view.zoomToAll();
  installHook(map);
}

function draw(map: Awaited<ReturnType<typeof createMap>>): void {
  scenarios.document.watch((scenario) => setData(map, "scenario", scenarioFeatures(scenario)));
  const drawItems = (): void => {
    const current = watched.value?.flight_id && watched.value.plan_id === open.value?.record.id ? watched.value.state.mission_current : null;
    setData(map, "waypoints", itemFeatures(open.value?.items ?? [], current));
  };
  const drawPlan = (): void => {
    const shown = open.value;
    setData(map, "plan", shown ? [...planFeatures(shown.plan, isDark()), ...phaseFeatures(shown.plan, shown.items)] : []);
    drawItems();
  };
  open.watch(drawPlan);
  onThemeChange(drawPlan);
  let current: number | null | undefined;
  watched.watch((vehicle) => {
    const now = vehicle?.flight_id ? vehicle.state.mission_current : null;
    if (now === current) return;
    current = now;
    drawItems();
  });
  held.watch((found) => setData(map, "held", found ? heldFeatures(found.items) : []));
  scenarios.replaced.watch(() => held.set(null));
  compared.watch((other) => setData(map, "compared", (other?.plan.features ?? []).filter((feature) => feature.properties?.["role"] === "path")));
}

/** List what there is whenever the service comes up; then show what the tab had, or the newest there is. */
function keepListing(before: ReturnType<typeof restore>, shown: () => void): void {
  let settled = false;
  let last = connection.value;
  connection.watch((state) => {
    const cameUp = state === "up" && last !== "up";
    last = state;
    if (!cameUp) return;
    void attempt("The plans and flights were not listed", async () => {
      await Promise.all([refresh(), refreshFlights()]);
      if (settled) return;
      settled = true;
      if (before === null) {
        if (await openNewest()) shown();
        else awaitFirst(shown);
      } else if (before.plan !== null) {
        await openPlan(before.plan, true);
      }
    });
  });
}

/** A page opened while the service begins with a scenario takes it when it comes; not once the operator has begun with something. */
function awaitFirst(shown: () => void): void {
  const before = scenarios.replaced.value;
  if (recent.value.length > 0) return;
  let over = false;
  recent.watch((records) => {
    if (over || records.length === 0) return;
    over = true;
    if (scenarios.replaced.value !== before) return;
    void attempt("The first plan was not opened", openNewest).then((opened) => opened && shown());
  });
}

start().catch((error: unknown) => report("The page could not start", error));
