/** Errors and news in words, at the corner of the page; errors and long news stay until they are closed, or what failed is done. */
import { ApiError } from "./api";
import { button, byId, h } from "./dom";
import { fixOf, messageOf, ownerWords } from "./finding_words";
import type { Finding } from "./types";

const NEWS_MS = 6000;
const READ_LINES = 3;

/** A finding without the name of its feature, for where that stands already. */
export function findingWords(finding: Finding): string {
  const fix = finding.fix ? ` ${fixOf(finding)}` : "";
  const rule = finding.rule ? ` (${finding.rule})` : "";
  return `${messageOf(finding)}${rule}.${fix}`.replace(/\.\./g, ".");
}

export function findingText(finding: Finding): string {
  return `${ownerWords(finding.feature)}: ${findingWords(finding)}`;
}

function show(kind: "error" | "news", title: string, lines: string[]): void {
  const notice = h(
    "div",
    { class: `notice ${kind}` },
    h("strong", {}, title),
    lines.length > 0 ? h("ul", {}, ...lines.map((line) => h("li", {}, line))) : null,
    button("×", () => notice.remove(), { class: "close", "aria-label": "Close this notice" }),
  );
  // The later one tells how it stands now.
  settled(title);
  notice.dataset["of"] = title;
  byId("notices").append(notice);
  // What takes longer to read than that waits to be closed.
  if (kind === "news" && lines.length < READ_LINES) setTimeout(() => notice.remove(), NEWS_MS);
}

/** It is done after all: what was said of its failure goes. */
export function settled(doing: string): void {
  for (const notice of [...byId("notices").children] as HTMLElement[]) if (notice.dataset["of"] === doing) notice.remove();
}

/** What was said of a scenario that is no longer there says nothing of this one. */
export function clearNotices(): void {
  byId("notices").replaceChildren();
}

export function news(text: string, ...lines: string[]): void {
  show("news", text, lines);
}

export function warn(title: string, ...lines: string[]): void {
  show("error", title, lines);
}

/** Say what went wrong: title and detail of a problem document, and each of its errors. */
export function report(doing: string, error: unknown): void {
  if (error instanceof ApiError) {
    const found = error.errors.map(findingText);
    const detail = error.problem.detail ?? "";
    // The detail most often is the first finding's message once more.
    const lines = [error.problem.title, found.some((line) => line.includes(detail)) ? "" : detail, ...found];
    show("error", doing, lines.filter((line) => line !== ""));
  } else {
    show("error", doing, [error instanceof Error ? error.message : String(error)]);
  }
}

/** Run something that may fail and report the failure; resolves to null then. */
export async function attempt<T>(doing: string, action: () => Promise<T>): Promise<T | null> {
  try {
    const done = await action();
    settled(doing);
    return done;
  } catch (error) {
    report(doing, error);
    return null;
  }
}
