/** Tabs as the ARIA practice has them: arrow keys move, one panel shows. */
import { fill, h } from "../dom";
import { Signal } from "../signal";

export interface Tab {
  id: string;
  label: string;
  content: HTMLElement;
}

export interface Tabs {
  element: HTMLElement;
  panels: HTMLElement[];
  /** The tab that shows. */
  shown: Signal<string>;
  show(id: string): void;
  /** Show a tab unless the operator has chosen one. */
  suggest(id: string): void;
  /** Put a few words behind a tab's label; none takes them away. */
  mark(id: string, words: string): void;
}

export function tabs(all: Tab[]): Tabs {
  const heads = all.map((tab) =>
    h("button", { type: "button", role: "tab", id: `tab-${tab.id}`, "aria-controls": `panel-${tab.id}`, onclick: () => choose(tab.id) }, tab.label),
  );
  const panels = all.map((tab) => h("div", { role: "tabpanel", id: `panel-${tab.id}`, "aria-labelledby": `tab-${tab.id}`, tabindex: 0 }, tab.content));
  const shownTab = new Signal<string>((all[0] as Tab).id);
  let chosen = false;
  const choose = (id: string): void => {
    chosen = true;
    show(id);
  };
  const show = (id: string): void => {
    all.forEach((tab, index) => {
      const shown = tab.id === id;
      heads[index]?.setAttribute("aria-selected", String(shown));
      heads[index]?.setAttribute("tabindex", shown ? "0" : "-1");
      const panel = panels[index];
      if (panel) panel.hidden = !shown;
    });
    if (shownTab.value !== id) shownTab.set(id);
  };
  const element = h("div", { class: "tabs", role: "tablist", "aria-label": "Scenario, plan, flight" }, ...heads);
  element.addEventListener("keydown", (event) => {
    const step = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
    const at = heads.indexOf(document.activeElement as HTMLButtonElement);
    if (!step || at < 0) return;
    const next = (at + step + all.length) % all.length;
    heads[next]?.focus();
    choose((all[next] as Tab).id);
  });
  show((all[0] as Tab).id);
  const mark = (id: string, words: string): void => {
    const at = all.findIndex((tab) => tab.id === id);
    const tab = all[at];
    if (tab && heads[at]) fill(heads[at], tab.label, words ? h("span", { class: "badge" }, words) : null);
  };
  return { element, panels, shown: shownTab, show, mark, suggest: (id) => (chosen ? undefined : show(id)) };
}
