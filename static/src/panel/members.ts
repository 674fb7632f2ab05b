/** One property of the nth vehicle or sensor, or of the scenario itself, read and written. */
import { scenarios } from "../scenario";
import type { Member, Scenario } from "../types";
import { choiceField, numberField, textField, tickField, type Field } from "./fields";

export type List = "vehicles" | "sensors";

interface Bound {
  get<T>(): T | undefined;
  /** Undefined takes it away. */
  set(value: unknown): void;
}

export function member(list: List, index: number, property: string): Bound {
  return {
    get: <T>() => scenarios.document.value[list]?.[index]?.[property] as T | undefined,
    set: (value) =>
      scenarios.change((draft) => {
        const target = draft[list]?.[index];
        if (!target) return;
        if (value === undefined) delete target[property];
        else target[property] = value;
      }),
  };
}

export function nested(group: "method" | "objective", property: string): Bound {
  return {
    get: <T>() => (scenarios.document.value[group] as Member | undefined)?.[property] as T | undefined,
    set: (value) =>
      scenarios.change((draft) => {
        const target: Member = { ...(draft[group] as Member | undefined) };
        if (value === undefined) delete target[property];
        else target[property] = value;
        if (Object.keys(target).length === 0) delete draft[group];
        else (draft as Member)[group] = target;
      }),
  };
}

export function top(property: keyof Scenario): Bound {
  return {
    get: <T>() => scenarios.document.value[property] as T | undefined,
    set: (value) =>
      scenarios.change((draft) => {
        if (value === undefined) delete draft[property];
        else draft[property] = value;
      }),
  };
}

/** `scale`: how many of the unit shown make one of the scenario's. */
interface Extra {
  scale?: number;
  min?: number;
  max?: number;
  required?: boolean;
  placeholder?: string;
  hint?: string;
}

/** Twelve digits: what scaling adds beyond is none of the operator's. */
export const tidy = (value: number): number => Number(value.toPrecision(12));

/** A number shown in another unit than the scenario has it in. */
export function scaled(bound: Bound, scale: number): { get(): number | undefined; set(value: number | undefined): void } {
  return {
    get: () => {
      const value = bound.get<number>();
      return typeof value === "number" ? tidy(Number((value * scale).toPrecision(7))) : undefined;
    },
    set: (value) => bound.set(value === undefined ? undefined : tidy(value / scale)),
  };
}

export function number(list: List, index: number, property: string, label: string, unit: string, { scale = 1, ...extra }: Extra = {}): Field {
  return numberField({ id: `${list}-${index}-${property}`, label, unit, min: 0, ...scaled(member(list, index, property), scale), ...extra });
}

/** A choice whose first entry is what holds when nothing is said. */
export function choice(list: List, index: number, property: string, label: string, choices: readonly (string | readonly [string, string])[], hint?: string): Field {
  const { get, set } = member(list, index, property);
  const first = choices[0] as string | readonly [string, string];
  const usual = typeof first === "string" ? first : first[0];
  return choiceField({ id: `${list}-${index}-${property}`, label, choices, ...(hint ? { hint } : {}), get: () => get<string>() ?? usual, set });
}

export function tick(list: List, index: number, property: string, label: string, hint: string): Field {
  const { get, set } = member(list, index, property);
  return tickField({ id: `${list}-${index}-${property}`, label, hint, get: () => get<boolean>() ?? false, set: (value) => set(value ? true : undefined) });
}

export function name(list: List, index: number): Field {
  const { get, set } = member(list, index, "name");
  return textField({
    id: `${list}-${index}-name`, label: "Name", get: () => get<string>(), set,
    refuse: (text) => (text === "" ? "A name is needed." : ""),
  });
}
