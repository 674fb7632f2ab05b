/** What is asked before another scenario takes the place of the one on the page. */
import { ask } from "./dialog";
import { freshness } from "./freshness";
import { keeping } from "./keeping";
import { scenarios } from "./scenario";

/** Whether the scenario on the page stands nowhere else: neither kept by the service, nor with a plan made of it. */
export function wouldBeLost(): boolean {
  const { state } = keeping.value;
  const unkept = state === "tab" || state === "changed" || state === "failed";
  return unkept && scenarios.edited.value && scenarios.document.value.features.length > 0 && freshness.value.state !== "fresh";
}

/** Whether to go on; asked only where something would be lost. */
export async function mayLeave(title: string, go: string): Promise<boolean> {
  const lines = ["The scenario on the page is replaced, and it is kept nowhere else: download it first if it is still needed."];
  return !wouldBeLost() || (await ask({ title, lines, go })) !== null;
}
