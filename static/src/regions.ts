/** Regions drawn in other programs: the service reads the file, its features join the scenario. */
import { ApiError, sendFile } from "./api";
import { news, report, warn } from "./notices";
import { askImport, isOpen, type LengthQuestion, type ShapeAccount } from "./roles";
import { scenarios } from "./scenario";
import type { Finding, Member, ScenarioFeature } from "./types";

/** Files that go to the service to be read. */
export const REGION_FILES = ".kml,.kmz,.wpml,.gpx,.gml,.zip,.shp,.geojsonl,.ndjson,.wkt,.csv,.tsv";

interface Imported {
  features: ScenarioFeature[];
  format: string;
  shapes: ShapeAccount[];
  left_out: Finding[];
  notes: string[];
  /** Of surveys: the cameras that their regions name, and what their heights count over. */
  sensors?: Member[];
  altitude_reference?: string;
}

/** What shapes can need and a file may not say: the rule of the finding is the length's name and "-missing". */
const LENGTHS: Record<string, LengthQuestion> = {
  width_m: { label: "Width of corridors, m", proposal: "200" },
  radius_m: { label: "Radius of threats and circles, m", proposal: "500" },
  height_m: { label: "Height of obstacles, m", proposal: "30" },
};

export function isRegionFile(file: File): boolean {
  return REGION_FILES.split(",").some((ending) => file.name.toLowerCase().endsWith(ending));
}

/** Read the file, ask what it does not say, add its features; false when it was refused or the operator stepped back. */
export async function importRegions(file: File): Promise<boolean> {
  const query = new URLSearchParams({ name: file.name });
  let rolesAsked = false;
  try {
    for (;;) {
      const { found, findings } = await read(file, query);
      const missing = Object.fromEntries(
        Object.entries(LENGTHS).filter(([name]) => !query.has(name) && findings.some(({ rule }) => rule === `${name}-missing`)),
      );
      const shapes = rolesAsked ? [] : (found?.shapes ?? pointsOf(findings));
      if (!shapes.some(isOpen) && Object.keys(missing).length === 0) {
        if (!found) throw new Error(findings.map(({ feature, message }) => `${feature}: ${message}`).join("; "));
        const before = scenarios.document.value.features.map((feature) => feature.properties.role);
        const reference = mountedOver(found);
        scenarios.merge(found.features, found.sensors, reference.use);
        if (reference.warning) warn(`Heights of ${file.name}`, reference.warning);
        news(`Added ${found.features.length} features of ${file.name}.`, ...replaced(before, found), ...told(found));
        return true;
      }
      const answer = await askImport(file.name, shapes, missing);
      if (answer === null) return false;
      rolesAsked = true;
      for (const [name, value] of Object.entries(answer.lengths)) query.set(name, value);
      for (const role of answer.roles) {
        if (found) query.append("role_of", role);
        else query.set("role", role.slice(role.lastIndexOf("=") + 1));
      }
    }
  } catch (error) {
    report(`${file.name} was not added`, error);
    return false;
  }
}

/** What heights of surveys count over: of a scenario with nothing in it that of the file; of another its own, which is told. */
function mountedOver({ altitude_reference, features }: Imported): { use?: string; warning?: string } {
  const { value: before } = scenarios.document;
  const asked = features.some(({ properties }) => properties["altitude_m"] !== undefined);
  if (altitude_reference === undefined || !asked || before.altitude_reference === altitude_reference) return {};
  if (before.features.length === 0) return { use: altitude_reference };
  return { warning: `They were over ${altitude_reference === "amsl" ? "the sea" : altitude_reference}, and heights of this scenario count over ${String(before.altitude_reference ?? "terrain")}: see the altitude of each region.` };
}

/** What the service makes of it; of a file of which nothing can be taken as it is, the findings alone. */
async function read(file: File, query: URLSearchParams): Promise<{ found: Imported | null; findings: Finding[] }> {
  try {
    const found = await sendFile<Imported>(`/scenarios/import?${query}`, file);
    return { found, findings: found.left_out };
  } catch (error) {
    if (!(error instanceof ApiError) || !error.errors.every(({ rule }) => rule === "role-unknown" || rule.endsWith("-missing"))) throw error;
    if (error.errors.length === 0) throw error;
    return { found: null, findings: error.errors };
  }
}

/** A file that holds nothing but points nobody knows says so in findings: one answer for all of them. */
function pointsOf(findings: Finding[]): ShapeAccount[] {
  const names = findings.filter(({ rule }) => rule === "role-unknown").map(({ feature }) => feature);
  if (names.length === 0) return [];
  return [{
    number: 1, name: names.slice(0, 6).join(", "), folders: [], kind: "point", role: "none",
    why: "nothing says what these points are", in_doubt: false, features: [],
  }];
}

/** Of these a scenario has one: the file's takes the place of the one there was. */
function replaced(before: string[], found: Imported): string[] {
  const roles = new Set(found.features.map((feature) => feature.properties.role as string));
  return ["area", "start", "end"]
    .filter((role) => before.includes(role) && roles.has(role))
    .map((role) => `the ${role} there was is replaced`);
}

function told(found: Imported): string[] {
  const doubtful = found.shapes.filter(({ in_doubt }) => in_doubt).length;
  const zones = found.shapes.filter(({ role }) => role === "no_fly").length;
  const out = found.shapes.filter(({ role }) => role === "none").length;
  return [
    zones > 0 ? `${zones} forbid flying` : "",
    doubtful > 0 ? `the role of ${doubtful} is in doubt: choose it before planning` : "",
    out > 0 ? `${out} left out` : "",
    ...found.left_out.map(({ feature, message }) => `${feature} ${message}`),
    ...found.notes,
  ].filter(Boolean);
}
