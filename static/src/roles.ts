/** Which role the shapes of a file have: shown with what says so, and chosen where nothing does. */
import { button, h } from "./dom";
import { ROLE_WORDS } from "./role_words";

/** What the service says of one shape of a file. */
export interface ShapeAccount {
  number: number;
  name: string;
  folders: string[];
  kind: "polygon" | "line" | "point";
  role: string;
  why: string;
  in_doubt: boolean;
  features: string[];
}

export interface LengthQuestion {
  label: string;
  proposal: string;
}

export interface Answer {
  roles: string[];
  lengths: Record<string, string>;
}

const CHOICES: Record<ShapeAccount["kind"], string[]> = {
  polygon: ["roi", "no_fly", "area", "obstacle", "importance"],
  line: ["roi", "no_fly", "area"],
  point: ["roi", "start", "end", "base", "threat", "no_fly"],
};
const MOST_NAMED = 6;

/** Roles that a shape of a scenario can have; the first forbids. */
export function rolesFor(geometryType: string): string[] {
  const kind = geometryType.endsWith("Point") ? "point" : geometryType.endsWith("LineString") ? "line" : "polygon";
  const can = kind === "line" ? ["roi"] : CHOICES[kind];
  return [...can].sort((a, b) => Number(b === "no_fly") - Number(a === "no_fly"));
}

/** Shapes alike share a line, and an answer. */
interface Group {
  first: ShapeAccount;
  names: string[];
  numbers: number[];
}

/** Whether somebody has to say what a shape is. */
export function isOpen(shape: ShapeAccount): boolean {
  return shape.in_doubt || (shape.role === "none" && shape.why.startsWith("nothing says"));
}

function grouped(shapes: ShapeAccount[]): Group[] {
  const found = new Map<string, Group>();
  for (const shape of shapes) {
    const key = [shape.kind, shape.role, shape.why, ...shape.folders].join("\u0000");
    const group = found.get(key) ?? { first: shape, names: [], numbers: [] };
    group.names.push(shape.name || `#${shape.number}`);
    group.numbers.push(shape.number);
    found.set(key, group);
  }
  return [...found.values()];
}

/** Numbers as the service takes them: `#1-3,7`. */
export function numbersOf(numbers: number[]): string {
  const parts: [number, number][] = [];
  for (const number of numbers) {
    const last = parts.at(-1);
    if (last && last[1] === number - 1) last[1] = number;
    else parts.push([number, number]);
  }
  return `#${parts.map(([from, to]) => (from === to ? `${from}` : `${from}-${to}`)).join(",")}`;
}

function wordsOf(role: string): string {
  return role === "none" ? "left out" : (ROLE_WORDS[role] ?? role);
}

function title(group: Group): string {
  const names = group.names.slice(0, MOST_NAMED).join(", ");
  const more = group.names.length - MOST_NAMED;
  return more > 0 ? `${names} and ${more} more` : names;
}

function row(group: Group, index: number, answers: Map<Group, string>): HTMLElement {
  const { first } = group;
  const keep = first.in_doubt ? "decide later: not to be planned before" : `keep: ${wordsOf(first.role)}`;
  const select = h(
    "select",
    { id: `import-role-${index}`, "data-shape": first.name, onchange: () => void answers.set(group, select.value) },
    h("option", { value: "" }, keep),
    ...[...CHOICES[first.kind], "none"].map((role) => h("option", { value: role }, wordsOf(role))),
  );
  return h(
    "li",
    {},
    h("label", { for: `import-role-${index}` }, `${title(group)} (${first.kind}): ${wordsOf(first.role)}`),
    h("p", { class: "quiet" }, [first.folders.join(" › "), first.why].filter(Boolean).join(": ")),
    select,
  );
}

/**
 * Ask for roles and lengths in one dialog; null when the operator steps back. Shapes whose role nobody doubts
 * are folded away, and can be changed as well.
 */
export function askImport(fileName: string, shapes: ShapeAccount[], lengths: Record<string, LengthQuestion>): Promise<Answer | null> {
  return new Promise((resolve) => {
    const answers = new Map<Group, string>();
    const groups = grouped(shapes);
    const open = groups.filter((group) => isOpen(group.first));
    const settled = groups.filter((group) => !isOpen(group.first));
    const inputs = Object.entries(lengths).map(([name, { label, proposal }]) => {
      const input = h("input", { id: `import-${name}`, type: "number", min: "0", step: "any", required: true, value: proposal });
      return { name, input, label: h("label", { for: `import-${name}` }, label) };
    });
    const finish = (answer: Answer | null): void => {
      dialog.close();
      dialog.remove();
      resolve(answer);
    };
    const go = (): void => {
      const bad = inputs.find(({ input }) => !(Number(input.value) > 0));
      if (bad) return bad.input.focus();
      const roles = [...answers].filter(([, role]) => role !== "").map(([group, role]) => `${numbersOf(group.numbers)}=${role}`);
      finish({ roles, lengths: Object.fromEntries(inputs.map(({ name, input }) => [name, input.value])) });
    };
    const list = (some: Group[]): HTMLElement => h("ul", { class: "roles" }, ...some.map((group) => row(group, groups.indexOf(group), answers)));
    const dialog = h(
      "dialog",
      { "aria-labelledby": "import-title" },
      h("h2", { id: "import-title" }, `What ${fileName} does not say`),
      open.length > 0 ? list(open) : null,
      ...inputs.flatMap(({ label, input }) => [label, input]),
      settled.length > 0 ? h("details", {}, h("summary", {}, "What the other shapes became"), list(settled)) : null,
      h("div", { class: "row" }, button("Cancel", () => finish(null)), button("Add", go, { class: "primary", id: "import-go" })),
    );
    dialog.addEventListener("cancel", () => finish(null));
    document.body.append(dialog);
    dialog.showModal();
  });
}
