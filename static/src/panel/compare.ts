/** Figures of the plan on the map beside those of another. */
import { fill, h } from "../dom";
import { attempt } from "../notices";
import { compared, compareWith, open, recent } from "../plans";
import type { Metrics } from "../types";
import { metres, number, percent, seconds } from "../units";

type Row = [label: string, value: (m: Metrics) => number | null | undefined, words: (value: number | null | undefined) => string];

const ROWS: Row[] = [
  ["Length", (m) => m.length_m, metres],
  ["Collecting", (m) => m.collection_length_m, metres],
  ["Duty cycle", (m) => m.duty_cycle, percent],
  ["Flight time", (m) => m.duration_s, seconds],
  ["Turns", (m) => m.turns, (v) => number(v, 0)],
  ["Risk, missile", (m) => m.risk_missile, (v) => number(v, 2)],
  ["Risk, radar", (m) => m.risk_radar, (v) => number(v, 2)],
  ["Least coverage", (m) => Math.min(1, ...Object.values(m.coverage ?? {})), (v) => percent(v, 2)],
];

function change(here: number | null | undefined, there: number | null | undefined): string {
  if (typeof here !== "number" || typeof there !== "number" || there === 0) return "";
  const share = (here - there) / Math.abs(there);
  return Math.abs(share) < 0.0005 ? "=" : `${share > 0 ? "+" : "−"}${percent(Math.abs(share), 1)}`;
}

export function comparison(): HTMLElement {
  const select = h("select", { id: "compare" });
  const figures = h("div", {});
  select.addEventListener("change", () => void attempt("The other plan cannot be shown", () => compareWith(select.value || null)));
  const list = (): void => {
    const others = recent.value.filter(({ id, state }) => state === "done" && id !== open.value?.record.id);
    fill(
      select,
      h("option", { value: "" }, others.length > 0 ? "none" : "there is no other plan"),
      ...others.map((record) => h("option", { value: record.id }, `${record.name ?? record.id} · ${metres(record.metrics?.length_m)} · ${record.created_at ? new Date(record.created_at).toLocaleTimeString() : ""}`)),
    );
    select.value = compared.value?.record.id ?? "";
    select.disabled = others.length === 0;
  };
  const draw = (): void => {
    list();
    const mine = open.value?.plan.metrics;
    const other = compared.value?.plan.metrics;
    fill(
      figures,
      mine && other
        ? h(
            "table",
            { id: "comparison", class: "compare" },
            h("thead", {}, h("tr", {}, h("td", {}), h("th", { scope: "col" }, "this"), h("th", { scope: "col" }, "other"), h("th", { scope: "col" }, "change"))),
            h(
              "tbody",
              {},
              ...ROWS.map(([label, value, words]) =>
                h("tr", {}, h("th", { scope: "row" }, label), h("td", {}, words(value(mine))), h("td", {}, words(value(other))), h("td", {}, change(value(mine), value(other)))),
              ),
            ),
          )
        : null,
    );
  };
  recent.watch(list);
  open.watch(draw);
  compared.watch(draw);
  return h("div", { class: "field" }, h("label", { for: "compare" }, "Compare with (drawn in grey on the map)"), select, figures);
}
