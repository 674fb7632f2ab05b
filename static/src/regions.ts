/** Regions drawn in other programs: the service reads the file, its features join the scenario. */
import { ApiError, sendFile } from "./api";
import { button, h } from "./dom";
import { news, report } from "./notices";
import { scenarios } from "./scenario";
import type { ScenarioFeature } from "./types";

/** Files that go to the service to be read. */
export const REGION_FILES = ".kml,.kmz,.gpx,.zip,.shp";

interface Imported {
  features: ScenarioFeature[];
  format: string;
  notes: string[];
}

/** What shapes can need and a file may not say: the rule of the refusal is the length's name and "-missing". */
const LENGTHS = {
  width_m: { label: "Width of corridors, m", proposal: "200" },
  radius_m: { label: "Radius of threats and circles, m", proposal: "500" },
  height_m: { label: "Height of obstacles, m", proposal: "30" },
} as const;
type Length = keyof typeof LENGTHS;

export function isRegionFile(file: File): boolean {
  return REGION_FILES.split(",").some((ending) => file.name.toLowerCase().endsWith(ending));
}

/** Read the file and add its features; false when it was refused or the operator stepped back. */
export async function importRegions(file: File): Promise<boolean> {
  const lengths: Partial<Record<Length, string>> = {};
  try {
    for (;;) {
      try {
        const found = await sendFile<Imported>(`/scenarios/import?${new URLSearchParams(lengths)}`, file);
        scenarios.merge(found.features);
        news([`Added ${found.features.length} features of ${file.name}.`, ...found.notes].join(" · "));
        return true;
      } catch (error) {
        const missing = missingLengths(error).filter((name) => lengths[name] === undefined);
        if (missing.length === 0) throw error;
        const answer = await askLengths(file.name, missing);
        if (answer === null) return false;
        Object.assign(lengths, answer);
      }
    }
  } catch (error) {
    report(`${file.name} was not added`, error);
    return false;
  }
}

/** The lengths asked for, where nothing else is wrong. */
function missingLengths(error: unknown): Length[] {
  if (!(error instanceof ApiError) || error.errors.length === 0) return [];
  const rules = new Set(error.errors.map((finding) => finding.rule));
  const names = (Object.keys(LENGTHS) as Length[]).filter((name) => rules.delete(`${name}-missing`));
  return rules.size === 0 ? names : [];
}

function askLengths(fileName: string, names: Length[]): Promise<Partial<Record<Length, string>> | null> {
  return new Promise((resolve) => {
    const inputs = names.map((name) =>
      h("input", { id: `import-${name}`, type: "number", min: "0", step: "any", required: true, value: LENGTHS[name].proposal }),
    );
    const finish = (answer: Partial<Record<Length, string>> | null): void => {
      dialog.close();
      dialog.remove();
      resolve(answer);
    };
    const go = (): void => {
      const bad = inputs.find((input) => !(Number(input.value) > 0));
      if (bad) return bad.focus();
      finish(Object.fromEntries(names.map((name, index) => [name, inputs[index]!.value])));
    };
    const dialog = h(
      "dialog",
      { "aria-labelledby": "import-title" },
      h("h2", { id: "import-title" }, `What ${fileName} does not say`),
      ...names.flatMap((name, index) => [h("label", { for: `import-${name}` }, LENGTHS[name].label), inputs[index]!]),
      h("div", { class: "row" }, button("Cancel", () => finish(null)), button("Add", go, { class: "primary", id: "import-go" })),
    );
    dialog.addEventListener("cancel", () => finish(null));
    document.body.append(dialog);
    dialog.showModal();
  });
}
