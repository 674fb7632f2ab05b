/** The scenario side of the panel: files, findings, features and settings. */
import { button, fill, h, section } from "../dom";
import { download } from "../download";
import { openFile } from "../drop";
import { fixOf, messageOf, ownerWords } from "../finding_words";
import { mayLeave } from "../leaving";
import { attempt } from "../notices";
import { MISSION_FILES } from "../mission_file";
import { REGION_FILES } from "../regions";
import { emptyScenario, nameOf, scenarios } from "../scenario";
import type { Finding } from "../types";
import { readiness } from "../api";
import { keeping, keepBeside, takeTheirs, type KeepState } from "../keeping";
import { judge, judgement, type Judgement } from "../validation";
import { ROLE_WORDS } from "../role_words";
import { featureForm, formKey } from "./feature_form";
import { fieldOf, goToField, markFields } from "./field_findings";
import { textField, type Field } from "./fields";
import { keptBox } from "./kept_box";
import { settingsForm, settingsKey } from "./settings_form";

/** What the panel asks of the map. */
export interface View {
  zoomTo(names: string[]): void;
  zoomToAll(): void;
}

const STATE_WORDS: Record<Judgement["state"], string> = {
  empty: "Nothing to check yet: draw or open a scenario.",
  asking: "Checking …",
  sound: "The service accepts this scenario.",
  refused: "The service refuses this scenario:",
  unknown: "Not checked: the service gave no answer.",
};

const KEPT_WORDS: Record<KeepState, string> = {
  shown: "As the service has it; an edit is kept by the service.",
  waiting: "Being kept …",
  kept: "Kept by the service.",
  tab: "Kept in this tab alone, over a reload; download it before the tab is closed.",
  changed: "Another tab changed this scenario meanwhile. Nothing is written over; what is edited here is not kept until you choose:",
  failed: "NOT kept: the service did not take it. It is tried again.",
};

function files(view: View): HTMLElement {
  const input = h("input", { type: "file", id: "file", accept: `.geojson,.json,application/geo+json,application/json,${REGION_FILES},${MISSION_FILES},.txt,.tif,.tiff,.hgt,.dt0,.dt1,.dt2`, class: "sr-only", tabindex: "-1", "aria-label": "File to open" });
  input.addEventListener("change", () => {
    const file = input.files?.[0];
    input.value = "";
    if (file) void openFile(file).then((opened) => opened && view.zoomToAll());
  });
  const start = async (): Promise<void> => {
    if (!(await mayLeave("Begin a new scenario?", "New scenario"))) return;
    scenarios.load(emptyScenario(), true);
  };
  const save = (): void => download(`${scenarios.document.value.name ?? "scenario"}.geojson`, scenarios.text(), "application/geo+json");
  return h(
    "div",
    { class: "row" },
    button("Open file …", () => input.click(), { title: "A scenario as GeoJSON, or regions as KML, KMZ, GPX or zipped shapefile to add, or a mission (.plan, .waypoints) to show; files can also be dropped on the page" }),
    input,
    button("Download", save),
    button("New", () => void start()),
    button("Show all", () => view.zoomToAll()),
  );
}

function findingItem(finding: Finding, view: View): HTMLElement {
  const known = scenarios.find(finding.feature) !== undefined;
  const text = h(
    "span",
    {},
    h("strong", {}, known ? finding.feature : ownerWords(finding.feature)),
    `: ${messageOf(finding)}${finding.fix ? "." : ""}`,
    finding.fix ? h("em", {}, ` ${fixOf(finding)}`) : null,
    finding.rule ? h("code", {}, ` ${finding.rule}`) : null,
  );
  const go = (): void => {
    if (known) {
      view.zoomTo([finding.feature]);
      scenarios.selection.set(finding.feature);
    }
    const field = fieldOf(finding);
    if (field) goToField(field);
  };
  const leads = known || fieldOf(finding) !== null;
  return h(
    "li",
    { class: finding.severity ?? "error" },
    leads ? h("button", { type: "button", class: "link", title: known ? "Show on the map" : "Go to the field", onclick: go }, text) : text,
  );
}

function findings(view: View): HTMLElement {
  const box = h("div", { class: "card", id: "findings", role: "status", "aria-live": "polite" });
  const tell = (): void => {
    const { state, findings: found } = judgement.value;
    box.dataset["state"] = state;
    fill(
      box,
      h("p", {}, state === "asking" && readiness.value === "starting" ? "To be checked as soon as the service is ready …" : STATE_WORDS[state]),
      found.length > 0 ? h("ul", { class: "findings" }, ...found.map((finding) => findingItem(finding, view))) : null,
      state === "unknown" ? button("Check again", () => void judge()) : null,
    );
  };
  judgement.watch(tell);
  readiness.watch(tell);
  return box;
}

const ORDER = ["roi", "threat", "no_fly", "obstacle", "importance", "area", "start", "end", "base"];

function features(view: View): HTMLElement {
  const box = h("div", { class: "chips" });
  let shown = "";
  const draw = (): void => {
    const sorted = [...scenarios.document.value.features].sort((a, b) => ORDER.indexOf(a.properties.role) - ORDER.indexOf(b.properties.role));
    const key = JSON.stringify(sorted.map((feature) => [nameOf(feature), feature.properties.role]));
    // Built anew only when the list itself changes: the focus stays where it is.
    if (key !== shown) {
      shown = key;
      fill(
        box,
        ...sorted.map((feature) => {
          const name = nameOf(feature);
          const select = (): void => {
            scenarios.selection.set(name);
            view.zoomTo([name]);
          };
          return button(name, select, { class: `chip ${feature.properties.role}`, "data-role": ROLE_WORDS[feature.properties.role] ?? feature.properties.role });
        }),
        sorted.length === 0 ? h("p", { class: "quiet" }, "No features. Use the tools over the map, or open a file.") : null,
      );
    }
    for (const chip of box.querySelectorAll("button")) {
      const name = chip.textContent ?? "";
      const worst = judgement.value.findings.filter((finding) => finding.feature === name).map(({ severity }) => severity ?? "error").sort()[0];
      chip.setAttribute("aria-pressed", String(name === scenarios.selection.value));
      chip.classList.toggle("wrong", worst === "error");
      chip.classList.toggle("doubtful", worst === "warning");
      chip.title = [chip.dataset["role"], worst === "error" ? "refused: see above" : worst === "warning" ? "a warning: see above" : ""].filter(Boolean).join("; ");
    }
  };
  scenarios.document.watch(draw);
  scenarios.selection.watch(draw);
  judgement.watch(draw);
  return section("Features", true, box);
}

/** The title of a section; the first of several is the one there was before. */
const titleOf = (part: HTMLDetailsElement): string => (part.querySelector("summary")?.textContent ?? "").replace(/ 1$/, "");

/** A box that holds a form, built anew only when its key changes and otherwise brought up to date. */
function kept(key: () => string, build: () => Field | null): HTMLElement {
  const box = h("div", {});
  let form: Field | null = null;
  let shown: string | null = null;
  const update = (): void => {
    const wanted = key();
    if (wanted !== shown) {
      shown = wanted;
      // What was open and had the focus stays so where there is the like of it.
      const opened = new Map([...box.querySelectorAll("details")].map((part) => [titleOf(part), part.open]));
      const focused = box.contains(document.activeElement) ? document.activeElement?.id : undefined;
      form = build();
      fill(box, form?.element ?? null);
      for (const part of box.querySelectorAll("details")) part.open = opened.get(titleOf(part)) ?? part.open;
      if (focused) document.getElementById(focused)?.focus();
    }
    form?.sync();
    markFields(box, judgement.value.findings);
  };
  scenarios.document.watch(update);
  scenarios.selection.watch(update);
  judgement.watch(update);
  return box;
}

export function scenarioPanel(view: View): HTMLElement {
  const selected = (): ReturnType<typeof scenarios.find> => scenarios.find(scenarios.selection.value);
  const title = textField({
    id: "s-name",
    label: "Scenario",
    placeholder: "untitled",
    get: () => scenarios.document.value.name,
    set: (name) => scenarios.change((draft) => (name === undefined ? delete draft.name : (draft.name = name))),
  });
  const origin = h("div", { id: "kept", role: "status" });
  keeping.watch(({ state }) => {
    origin.className = state === "changed" || state === "failed" ? "error banner" : "quiet";
    fill(
      origin,
      KEPT_WORDS[state],
      state === "changed" ? h("div", { class: "row" }, button("Take the other tab's", () => void attempt("The other tab's scenario was not opened", takeTheirs)), button("Keep this one beside it", () => void attempt("The scenario was not kept", keepBeside))) : null,
    );
  });
  return h(
    "div",
    {},
    files(view),
    kept(() => "name", () => title),
    origin,
    findings(view),
    kept(
      () => formKey(selected()),
      () => {
        const feature = selected();
        return feature ? featureForm(feature, () => view.zoomTo([nameOf(feature)])) : null;
      },
    ),
    features(view),
    keptBox(view),
    kept(() => settingsKey(scenarios.document.value), () => settingsForm()),
  );
}
