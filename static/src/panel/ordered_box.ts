/** What was ordered of the vehicle and what became of it; there after a reload, and what other tabs ordered too. */
import { fill, h, section } from "../dom";
import { ordered, orderWords, OUTCOMES, type Ordered } from "../ordered";

const TONES: Record<string, string> = { pending: "warning", refused: "error", unknown: "error", different: "error", overtaken: "quiet" };

/** Their reason says no more than the outcome. */
const SAID = new Set(["done", "accepted"]);

function line(entry: Ordered): HTMLElement {
  const by = entry.actor === "service" ? " by the service itself" : "";
  return h(
    "li",
    { "data-order": String(entry.what["command"] ?? entry.kind), "data-outcome": entry.outcome },
    h("span", { class: "quiet" }, `${new Date(entry.at).toLocaleTimeString()} `),
    h("strong", {}, orderWords(entry)),
    `${by}: `,
    h("span", { class: TONES[entry.outcome] ?? "good" }, OUTCOMES[entry.outcome] ?? entry.outcome),
    entry.reason && !SAID.has(entry.outcome) ? h("span", { class: "quiet" }, ` – ${entry.reason}`) : null,
  );
}

export function orderedBox(): HTMLElement {
  const items = h("ul", { class: "plain", id: "ordered" });
  const under = h("p", { class: "warning", id: "under-way", role: "status", hidden: true });
  ordered.watch((entries) => {
    const moving = entries.filter(({ outcome }) => outcome === "pending");
    under.hidden = moving.length === 0;
    const words = moving.length === 0 ? "" : `Under way: ${moving.map(orderWords).join(", ")}.`;
    if (under.textContent !== words) under.textContent = words;
    fill(items, ...entries.map(line), entries.length === 0 ? h("li", { class: "quiet" }, "Nothing yet.") : null);
  });
  return h("div", {}, under, section("What was ordered", false, items));
}
