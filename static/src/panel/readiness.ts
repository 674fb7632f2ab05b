/** The check before flight: its verdict open to see, what is in order folded away. */
import { h, section } from "../dom";
import { freshness } from "../freshness";
import { open } from "../plans";
import type { Preflight } from "../types";
import { figure } from "../units";

/** What speaks against flying it although the vehicle is in order: it is not what is on the page. */
function against(found: Preflight): string {
  if (open.value?.record.id !== found.plan_id) return "but of another plan than the one on the map";
  return freshness.value.state === "stale" ? `but its plan is out of date. ${freshness.value.reason}` : "";
}

export function readiness(found: Preflight): HTMLElement {
  const line = ({ name, status, detail }: Preflight["checks"][number]): HTMLElement =>
    h("li", { class: status === "failed" ? "error" : status === "warning" ? "warning" : "sound" }, h("strong", {}, name.replaceAll("_", " ")), `: ${detail}`);
  const doubtful = found.checks.filter(({ status }) => status !== "ok");
  const sound = found.checks.filter(({ status }) => status === "ok");
  const but = against(found);
  const ready = doubtful.length > 0 ? "Ready to fly; for the pilot to weigh:" : "Ready to fly: every check is in order.";
  return h(
    "div",
    { class: "card", "data-ready": String(found.ready && but === "") },
    h("p", { class: found.ready && but === "" ? "good" : "error" }, !found.ready ? "Not ready to fly:" : but ? `NOT to be flown as it is: the vehicle is in order, ${but}` : ready),
    doubtful.length > 0 ? h("ul", { class: "findings" }, ...doubtful.map(line)) : null,
    found.parameters.length > 0
      ? h(
          "ul",
          { class: "findings" },
          ...found.parameters.map((p) =>
            h("li", { class: p.severity }, h("strong", {}, p.name), ` is ${p.value === null ? "–" : figure(p.value)}${p.advised === null ? "" : `, ${figure(p.advised)} would do`}: ${p.reason}`),
          ),
        )
      : null,
    sound.length > 0 ? section(`${sound.length} checks in order`, false, h("ul", { class: "findings" }, ...sound.map(line))) : null,
  );
}
