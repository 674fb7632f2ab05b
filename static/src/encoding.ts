/** What a plan leaves open of its mission: how the sensor is switched and pointed. */
import { Signal } from "./signal";

export interface Encoding {
  /** Null for the default. */
  payload: string | null;
  gimbal: string | null;
}

export const encoding = new Signal<Encoding>({ payload: null, gimbal: null });

/** Only what differs from the default is sent. */
export function bodyOf({ payload, gimbal }: Encoding): Record<string, string> {
  return { ...(payload ? { payload } : {}), ...(gimbal ? { gimbal } : {}) };
}

export function queryOf(how: Encoding): string {
  const query = new URLSearchParams(bodyOf(how)).toString();
  return query ? `?${query}` : "";
}
