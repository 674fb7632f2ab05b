/** Take a file from a drop on the page or from the file dialog: a scenario, or regions, a mission or a raster of another program. */
import { choose } from "./dialog";
import { byId } from "./dom";
import { mayLeave } from "./leaving";
import { isMissionFile, openMission } from "./mission_file";
import { attempt, news, report } from "./notices";
import { importRegions, isRegionFile } from "./regions";
import { ROLE_WORDS } from "./role_words";
import { parseScenario, scenarios } from "./scenario";
import { sendRaster } from "./terrain";

const GEOMETRY = /^(Feature|(Multi)?(Point|LineString|Polygon)|GeometryCollection)$/;
/** Names of rasters, and of those that hold nothing but heights. */
const RASTER_FILES = /\.(tiff?|hgt|dt[012])$/i;
const ELEVATION_FILES = /\.(hgt|dt[012])$/i;
const LIMIT_BYTES = 20_000_000;

/** What a file that was opened has brought; null where it was not. */
export type Opened = "scenario" | "plan" | null;

/** Open a scenario in place of the one shown, add another program's regions to it, or show its mission. */
export async function openFile(file: File): Promise<Opened> {
  if (await isMissionFile(file)) {
    const how = (await holdsSurveys(file)) ? await askSurveys(file) : "mission";
    if (how === null) return null;
    if (how === "mission") return (await openMission(file)) ? "plan" : null;
    return (await importRegions(file)) ? "scenario" : null;
  }
  if (RASTER_FILES.test(file.name)) return (await openRaster(file)) ? "scenario" : null;
  const drawn = isRegionFile(file) || (await isDrawnElsewhere(file));
  return (await (drawn ? importRegions(file) : openScenario(file))) ? "scenario" : null;
}

/** A raster becomes the ground of the scenario on the page, or, of a kind that can hold it, what a search is worth. */
async function openRaster(file: File): Promise<boolean> {
  const what = ELEVATION_FILES.test(file.name)
    ? "terrain"
    : await choose(`${file.name} is a raster`, "What are its values, for the scenario on the page?", [
        ["terrain", "Heights of the ground"],
        ["importance_raster", "Importance of the ground"],
      ]);
  if (what !== "terrain" && what !== "importance_raster") return false;
  const sent = await attempt(`${file.name} was not taken`, () => sendRaster(file, what === "importance_raster"));
  if (!sent) return false;
  scenarios.change((draft) => {
    draft[what] = sent.id;
  });
  news(`${file.name} is ${what === "terrain" ? "the ground of the scenario" : "what the scenario's search is worth"} now.`);
  return true;
}

/** Whether it is a plan with areas that a survey was laid over. */
async function holdsSurveys(file: File): Promise<boolean> {
  if (!file.name.toLowerCase().endsWith(".plan") || file.size > LIMIT_BYTES) return false;
  return /"(complexItemType|type)"\s*:\s*"(survey|CorridorScan|StructureScan)"/.test(await file.text());
}

/** A plan with surveys is two things: what was asked for, and what was made of it. */
async function askSurveys(file: File): Promise<"regions" | "mission" | null> {
  const answer = await choose(`${file.name} holds surveys`, "Take over what they ask for (outlines, headings, cameras, heights), to be planned here, or show the mission as it is?", [
    ["regions", "Take over the surveys"],
    ["mission", "Show the mission"],
  ]);
  return answer as "regions" | "mission" | null;
}

/** Whether it is GeoJSON, or Esri JSON, whose shapes have no roles of a scenario, or no JSON at all: the service reads it, or says what it is. */
async function isDrawnElsewhere(file: File): Promise<boolean> {
  if (file.size > LIMIT_BYTES) return false;
  const text = await file.text();
  if (/^\s*[^\s[{]/.test(text)) return true;
  try {
    const document = JSON.parse(text) as { type?: unknown; features?: unknown; rings?: unknown } | null;
    if (!document || typeof document !== "object" || "vehicles" in document) return false;
    if (document.type !== "FeatureCollection") return document.type !== undefined ? GEOMETRY.test(String(document.type)) : "rings" in document || "geometryType" in document;
    if (!Array.isArray(document.features) || document.features.length === 0) return false;
    return document.features.some((feature: { properties?: { role?: unknown } } | null) => !(String(feature?.properties?.role) in ROLE_WORDS));
  } catch {
    // broken JSON: the scenario's reader says so in its words
    return false;
  }
}

async function openScenario(file: File): Promise<boolean> {
  try {
    if (file.size > LIMIT_BYTES) throw new Error(`The file has ${(file.size / 1e6).toFixed(1)} MB, more than a scenario can have.`);
    const scenario = parseScenario(await file.text());
    scenario.name ??= file.name.replace(/\.(geo)?json$/i, "");
    if (!(await mayLeave(`Open ${file.name}?`, "Open"))) return false;
    scenarios.load(scenario, true);
    news(`Opened ${file.name}: ${scenario.features.length} features.`);
    return true;
  } catch (error) {
    report(`${file.name} was not opened`, error);
    return false;
  }
}

/** Let the whole page take a dropped file; `then` runs after one was opened. */
export function acceptDrops(then: (opened: "scenario" | "plan") => void): void {
  const curtain = byId("drop");
  let depth = 0;
  const carriesFile = (event: DragEvent): boolean => event.dataTransfer?.types.includes("Files") ?? false;
  addEventListener("dragenter", (event) => {
    if (!carriesFile(event)) return;
    depth += 1;
    curtain.hidden = false;
  });
  addEventListener("dragleave", () => {
    depth = Math.max(0, depth - 1);
    if (depth === 0) curtain.hidden = true;
  });
  addEventListener("dragover", (event) => event.preventDefault());
  addEventListener("drop", (event) => {
    event.preventDefault();
    depth = 0;
    curtain.hidden = true;
    const file = event.dataTransfer?.files[0];
    if (file) void openFile(file).then((opened) => opened && then(opened));
  });
}
