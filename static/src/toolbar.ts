/** The drawing tools over the map, and what to do next in words. */
import { button, byId, fill, h } from "./dom";
import { TOOLS, type Drawing } from "./draw";
import { scenarios } from "./scenario";

export function buildToolbar(drawing: Drawing): void {
  const buttons = TOOLS.map((tool) => {
    const made = button(tool.label, () => drawing.use(drawing.tool.value === tool ? null : tool), {
      class: `tool ${tool.id}`,
      title: `Draw: ${tool.label}`,
      "data-tool": tool.id,
    });
    return { tool, made };
  });
  fill(
    byId("tools"),
    ...buttons.map(({ made }) => made),
    h("span", { class: "gap" }),
    button("↶", () => scenarios.undo(), { title: "Undo (Ctrl+Z)", "aria-label": "Undo" }),
    button("↷", () => scenarios.redo(), { title: "Redo (Ctrl+Shift+Z)", "aria-label": "Redo" }),
  );
  drawing.tool.watch((active) => {
    for (const { tool, made } of buttons) made.setAttribute("aria-pressed", String(tool === active));
    const hint = byId("hint");
    // Under the tools, which take two rows and more in a narrow window.
    hint.style.top = `${byId("tools").offsetHeight + 16}px`;
    hint.classList.toggle("shown", active !== null);
    if (active) fill(hint, `${active.label}: ${active.hint} `, button("Place in the middle", () => drawing.placeAtCentre(active)));
    else fill(hint);
  });
}
