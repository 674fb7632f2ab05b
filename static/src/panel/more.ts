/** A list that shows its newest entries, and more of them when asked. */
import { button, fill, h } from "../dom";
import type { Signal } from "../signal";

interface Watched {
  watch(listener: () => void): unknown;
}

const STEP = 10;

export function moreOf<T>(id: string, entries: Signal<T[]>, line: (entry: T) => HTMLElement, others: Watched[] = []): HTMLElement {
  const items = h("ul", { class: "plain", id });
  let most = STEP;
  const draw = (): void => {
    const all = entries.value;
    const more = button(`Show more (${all.length - most})`, () => {
      most += STEP;
      draw();
    });
    fill(
      items,
      ...all.slice(0, most).map(line),
      all.length > most ? h("li", {}, more) : null,
      all.length === 0 ? h("li", { class: "quiet" }, "None yet.") : null,
    );
  };
  entries.watch(draw);
  for (const other of others) other.watch(draw);
  return items;
}
