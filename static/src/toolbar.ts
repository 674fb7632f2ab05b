/** The drawing tools over the map, and what to do next in words. */
import { button, byId, fill, h } from "./dom";
import { TOOLS, type Drawing } from "./draw";
import { scenarios } from "./scenario";

const SVG = "http://www.w3.org/2000/svg";

function lockSign(): SVGElement {
  const svg = document.createElementNS(SVG, "svg");
  for (const [name, value] of Object.entries({ viewBox: "0 0 16 18", width: "13", height: "15", "aria-hidden": "true" })) svg.setAttribute(name, value);
  const path = document.createElementNS(SVG, "path");
  path.setAttribute("d", "M2 8h12v9H2z M4.500 8V5.500a3.500 3.500 0 0 1 7 0V8");
  for (const [name, value] of Object.entries({ fill: "none", stroke: "currentColor", "stroke-width": "2" })) path.setAttribute(name, value);
  svg.append(path);
  return svg;
}

/** `edit` leads to where geometry is changed. */
export function buildToolbar(drawing: Drawing, edit: () => void): void {
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
    h(
      "span",
      { class: "pair" },
      button("↶", () => scenarios.undo(), { title: "Undo (Ctrl+Z)", "aria-label": "Undo" }),
      button("↷", () => scenarios.redo(), { title: "Redo (Ctrl+Shift+Z)", "aria-label": "Redo" }),
    ),
    ...buttons.map(({ made }) => made),
  );
  const lock = byId("lock");
  fill(lock, lockSign(), h("span", {}, "Geometry is locked"), button("Edit the scenario", edit, { class: "link", id: "unlock" }));
  drawing.locked.watch((locked) => {
    lock.hidden = !locked;
    byId("tools").hidden = locked;
  });
  const hint = byId("hint");
  const size = h("output", { id: "drawn-size", "aria-live": "off" });
  const words = h("span", {});
  fill(hint, words, size);
  const tell = (): void => {
    // Under the tools, which take two rows and more in a narrow window.
    hint.style.top = `${byId("tools").offsetHeight + 16}px`;
    hint.classList.toggle("shown", drawing.tool.value !== null || drawing.size.value !== "");
  };
  drawing.tool.watch((active) => {
    for (const { tool, made } of buttons) made.setAttribute("aria-pressed", String(tool === active));
    if (active) fill(words, `${active.label}: ${active.hint} `, button("Place in the middle", () => drawing.placeAtCentre(active)));
    else fill(words);
    tell();
  });
  drawing.size.watch((said) => {
    size.textContent = said;
    tell();
  });
}
