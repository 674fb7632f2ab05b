/** Scenarios the service keeps: to go on with one of them, or to delete it. */
import { ask } from "../dialog";
import { button, fill, h, section } from "../dom";
import { deleteKept, keeping, keptScenarios, openKept, refreshKept } from "../keeping";
import { mayLeave } from "../leaving";
import { openItsPlan } from "../newest";
import { attempt } from "../notices";
import type { KeptRecord } from "../types";
import type { View } from "./scenario_panel";

const MOST_SHOWN = 30;

export function keptBox(view: View): HTMLElement {
  const list = h("ul", { class: "plain", id: "kept-scenarios" });
  const box = section("Kept scenarios", false, list, button("Refresh", () => void attempt("The kept scenarios were not listed", refreshKept)));
  const show = async (record: KeptRecord): Promise<void> => {
    if (!(await mayLeave("Open this scenario?", "Open"))) return;
    await attempt("The scenario was not opened", async () => {
      await openKept(record.id);
      view.zoomToAll();
      await openItsPlan(record.id);
    });
  };
  const gone = async (record: KeptRecord): Promise<void> => {
    const lines = ["Plans made of it stay, and count as out of date."];
    if ((await ask({ title: `Delete the scenario “${record.name ?? "untitled"}”?`, lines, go: "Delete" })) !== null) await attempt("The scenario was not deleted", () => deleteKept(record.id));
  };
  const line = (record: KeptRecord): HTMLElement =>
    h(
      "li",
      {},
      button(record.name ?? "untitled", () => void show(record), { class: "link", "aria-current": record.id === keeping.value.id }),
      h("span", { class: "quiet" }, ` ${new Date(record.changed_at).toLocaleString()} `),
      button("Delete", () => void gone(record), { class: "link quiet", "aria-label": `Delete the scenario ${record.name ?? "untitled"}` }),
    );
  const draw = (): void => {
    const found = keptScenarios.value;
    box.hidden = found === null;
    fill(list, ...(found ?? []).slice(0, MOST_SHOWN).map(line), found?.length === 0 ? h("li", { class: "quiet" }, "None yet.") : null);
  };
  keptScenarios.watch(draw);
  let id: string | null | undefined;
  keeping.watch((now) => {
    if (now.id === id) return;
    id = now.id;
    draw();
  });
  return box;
}
