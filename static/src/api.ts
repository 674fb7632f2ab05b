/** The service's HTTP interface: JSON in, JSON out, problem documents as `ApiError`, server-sent events. */
import { Signal } from "./signal";
import type { Finding, Position, Problem } from "./types";

/** Whether the service answers; kept up to date by every call and by a heartbeat. */
export const connection = new Signal<"unknown" | "up" | "down">("unknown");

/** Whether it can plan: after an install it compiles for a minute before it can. */
export type Readiness = "unknown" | "ready" | "starting" | "failing";
export const readiness = new Signal<Readiness>("unknown");

const HEARTBEAT_MS = 5000;
const STARTING_MS = 1500;
const root = new URL("./", document.baseURI);

export function apiUrl(path: string): string {
  return new URL(`api/v1${path}`, root).href;
}

/** A refusal of the service, as its problem document words it (RFC 9457). */
export class ApiError extends Error {
  readonly status: number;
  readonly problem: Problem;

  constructor(status: number, problem: Problem) {
    super(problem.detail ? `${problem.title}: ${problem.detail}` : problem.title);
    this.status = status;
    this.problem = problem;
  }

  get errors(): Finding[] {
    return readFindings(this.problem.errors);
  }
}

/** The service could not be reached at all. */
export class NoConnection extends Error {
  constructor(cause: unknown) {
    super("The service does not answer. The page keeps trying; nothing of your work is lost.", { cause });
  }
}

/** Findings, whatever else stands in the list (request-shape errors have `loc` and `msg`). */
export function readFindings(value: unknown): Finding[] {
  if (!Array.isArray(value)) return [];
  return value.map((entry: Record<string, unknown>) => ({
    feature: String(entry["feature"] ?? (Array.isArray(entry["loc"]) ? entry["loc"].join(".") : "request")),
    rule: String(entry["rule"] ?? entry["type"] ?? ""),
    message: String(entry["message"] ?? entry["msg"] ?? entry["detail"] ?? ""),
    fix: String(entry["fix"] ?? ""),
    severity: entry["severity"] === "warning" ? "warning" : "error",
    ...(Array.isArray(entry["where"]) ? { where: entry["where"] as Position } : {}),
  }));
}

async function problemOf(response: Response): Promise<Problem> {
  const fallback: Problem = { title: `${response.status} ${response.statusText || "refused"}`, status: response.status };
  const text = await response.text();
  try {
    const body: unknown = JSON.parse(text);
    if (body && typeof body === "object" && "title" in body) return body as Problem;
    return { ...fallback, detail: text.slice(0, 500) };
  } catch {
    return { ...fallback, detail: text.slice(0, 500) };
  }
}

async function send(url: string, init: RequestInit): Promise<Response> {
  let response: Response;
  try {
    response = await fetch(url, { cache: "no-store", ...init });
  } catch (error) {
    if (init.signal?.aborted) throw error;
    connection.set("down");
    throw new NoConnection(error);
  }
  if (connection.value !== "up") connection.set("up");
  if (!response.ok) throw new ApiError(response.status, await problemOf(response));
  return response;
}

async function call<T>(method: string, path: string, body?: unknown, headers: Record<string, string> = {}): Promise<T> {
  const init: RequestInit = { method, headers: { accept: "application/json, application/problem+json", ...headers } };
  if (body !== undefined) {
    init.body = JSON.stringify(body);
    init.headers = { ...init.headers, "content-type": "application/json" };
  }
  const response = await send(apiUrl(path), init);
  const text = await response.text();
  return (text ? JSON.parse(text) : null) as T;
}

export const get = <T>(path: string): Promise<T> => call<T>("GET", path);
export const post = <T>(path: string, body: unknown): Promise<T> => call<T>("POST", path, body);
/** Write over what is there, unless it is no longer what `tag` says: then 412. */
export const put = <T>(path: string, body: unknown, tag: string): Promise<T> => call<T>("PUT", path, body, { "if-match": tag });
export const remove = (path: string): Promise<unknown> => call<unknown>("DELETE", path);

/** Send a file as it is, and read the JSON answered. */
export async function sendFile<T>(path: string, file: File): Promise<T> {
  const headers = { accept: "application/json, application/problem+json", "content-type": "application/octet-stream" };
  const response = await send(apiUrl(path), { method: "POST", headers, body: file });
  return (await response.json()) as T;
}

/** A list answer, bare or under one key. */
export async function list<T>(path: string, key: string): Promise<T[]> {
  const answer = await get<unknown>(path);
  if (Array.isArray(answer)) return answer as T[];
  const inner = answer && typeof answer === "object" ? (answer as Record<string, unknown>)[key] : undefined;
  if (!Array.isArray(inner)) throw new Error(`${path} answered with no list of ${key}`);
  return inner as T[];
}

export interface StreamEvent {
  event: string;
  data: unknown;
}

/** One block of a server-sent event stream; null for comments and keep-alives. */
export function parseEvent(block: string): StreamEvent | null {
  let event = "message";
  const data: string[] = [];
  for (const line of block.split(/\r\n|\r|\n/)) {
    if (line.startsWith("event:")) event = line.slice(6).trim();
    else if (line.startsWith("data:")) data.push(line.slice(5).replace(/^ /, ""));
  }
  if (data.length === 0) return null;
  const text = data.join("\n");
  try {
    return { event, data: JSON.parse(text) };
  } catch {
    return { event, data: text };
  }
}

async function readStream(path: string, signal: AbortSignal, onEvent: (event: StreamEvent) => void): Promise<void> {
  const response = await send(apiUrl(path), { headers: { accept: "text/event-stream" }, signal });
  if (!response.body) return;
  const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
  let rest = "";
  for (;;) {
    const { value, done } = await reader.read();
    if (done) return;
    const blocks = (rest + value).split(/\r\n\r\n|\n\n|\r\r/);
    rest = blocks.pop() ?? "";
    for (const block of blocks) {
      const event = parseEvent(block);
      if (event) onEvent(event);
    }
  }
}

/**
 * Follow a stream until the returned function is called. A broken line is said through `onState` and tried
 * again after a growing pause; a refusal (4xx) ends it and goes to `onRefusal`.
 */
export function follow(
  path: string,
  onEvent: (event: StreamEvent) => void,
  onState: (state: "open" | "broken") => void,
  onRefusal: (error: ApiError) => void,
): () => void {
  const abort = new AbortController();
  const run = async (): Promise<void> => {
    let pause_ms = 500;
    while (!abort.signal.aborted) {
      try {
        await readStream(path, abort.signal, (event) => {
          pause_ms = 500;
          onState("open");
          onEvent(event);
        });
      } catch (error) {
        if (error instanceof ApiError && error.status < 500) return onRefusal(error);
      }
      if (abort.signal.aborted) return;
      onState("broken");
      await new Promise((resume) => setTimeout(resume, pause_ms));
      pause_ms = Math.min(pause_ms * 2, 10_000);
    }
  };
  void run();
  return () => abort.abort();
}

async function askReadiness(): Promise<void> {
  // 503 is an answer here, too.
  const response = await fetch(new URL("health/ready", root).href, { cache: "no-store", signal: AbortSignal.timeout(HEARTBEAT_MS) });
  const { status } = (await response.json()) as { status?: string };
  const found: Readiness = status === "ok" ? "ready" : status === "starting" || status === "failing" ? status : "unknown";
  if (found !== readiness.value) readiness.set(found);
}

/** Ask now and then whether the service lives, so that a loss is seen without a click, and until it is, whether it can plan. */
export function heartbeat(): void {
  const beat = async (): Promise<void> => {
    try {
      await send(new URL("health/live", root).href, { signal: AbortSignal.timeout(HEARTBEAT_MS) });
      if (readiness.value !== "ready") await askReadiness();
    } catch (error) {
      connection.set(error instanceof ApiError ? "up" : "down");
    }
    setTimeout(() => void beat(), readiness.value === "starting" ? STARTING_MS : HEARTBEAT_MS);
  };
  // It may be another one that answers next.
  connection.watch((state) => state === "down" && readiness.value !== "unknown" && readiness.set("unknown"));
  void beat();
}
