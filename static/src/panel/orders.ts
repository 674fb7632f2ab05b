/** What an order will do to this aircraft as it is now, said before it is given. */
import { freshness } from "../freshness";
import { ageWords, hearing } from "../hearing";
import { inFlight, planName } from "../holding";
import { open } from "../plans";
import type { Vehicle } from "../types";
import type { Command } from "../fleet";
import { metres, number, seconds } from "../units";

export interface Order {
  name: Command;
  label: string;
  title: string;
  /** It makes safe: shown in the first place, apart from the others, while it flies; sent to one that is silent, too. */
  urgent?: boolean;
}

export const ORDERS: Order[] = [
  { name: "arm", label: "Arm", title: "The motors may start" },
  { name: "start", label: "Start mission", title: "Arms if it has to, takes off and flies the mission it holds" },
  { name: "pause", label: "Pause", title: "Leaves its line and waits: in a circle, or hovering" },
  { name: "resume", label: "Resume", title: "Goes on with the mission" },
  { name: "hold", label: "Hold", title: "Stays where it is: in a circle, or hovering", urgent: true },
  { name: "rtl", label: "Return (RTL)", title: "Gives up the mission and returns to launch", urgent: true },
  { name: "land", label: "Land", title: "Lands now", urgent: true },
  { name: "sensor_off", label: "Sensor off", title: "Switches the payload off, whatever else it does", urgent: true },
  { name: "disarm", label: "Disarm", title: "The motors stop; an aircraft in flight refuses it" },
];

export interface Saying {
  title: string;
  lines: string[];
  go: string;
}

const KINDS: Record<string, string> = { ardupilot: "ArduPilot", px4: "PX4" };
/** Modes in which an armed aircraft flies its mission at once. */
const FLIES_BY_ITSELF = /^(AUTO|MISSION|AUTO\.MISSION|AUTO[ _]TAKEOFF|TAKEOFF|GUIDED)$/i;

function who({ name, state }: Vehicle): string {
  const kind = [KINDS[state.autopilot] ?? "", state.type.replaceAll("_", " ")].filter(Boolean).join(" ");
  return `${name} (${kind})`;
}

/** What it holds, as far as it is known, and what is wrong with that. */
function heldLines({ sent }: Vehicle): string[] {
  if (!sent) return ["What it holds was not sent from here: its mission is not known."];
  const mission = sent.standing === "differs" ? `It does NOT hold what was sent to it (${planName(sent.plan_id)}).` : sent.standing === "unknown" ? `Whether it still holds ${planName(sent.plan_id)} is not known.` : "";
  if (mission) return [mission];
  const shown = open.value;
  if (!shown || shown.record.id !== sent.plan_id) return [`It holds ${planName(sent.plan_id)}. That is not known to be the plan on the map.`];
  const { metrics } = shown.plan;
  const whole = metrics.flight_length_m ?? metrics.length_m;
  const time = metrics.flight_duration_s ?? metrics.duration_s;
  const part = metrics.flight_length_m == null ? ", take-off and return not counted" : "";
  return [`It flies the plan on the map, “${shown.plan.name ?? "unnamed"}”: ${metres(whole)}, ${seconds(time)}${part}.`, ...(freshness.value.state === "stale" ? [`That plan is OUT OF DATE. ${freshness.value.reason}`] : [])];
}

/** What of its state speaks against moving it. */
function doubts(vehicle: Vehicle): string[] {
  const heard = hearing(vehicle);
  const { battery_percent, gps_fix } = vehicle.state;
  return [
    heard.tone === "warning" || heard.tone === "error" ? `Its link is ${heard.words}; its position is ${ageWords(heard)} old.` : "",
    battery_percent !== null && battery_percent < 30 ? `Its battery is at ${number(battery_percent, 0, "%")}.` : "",
    gps_fix !== null && (gps_fix === "none" || gps_fix === "2d") ? `It has no 3D position fix (${gps_fix}).` : "",
  ].filter(Boolean);
}

function startSaying(vehicle: Vehicle): Saying {
  const flies = inFlight(vehicle);
  const arms = !vehicle.state.armed;
  const moves = flies ? `${who(vehicle)} goes over to its mission now.` : arms ? `${who(vehicle)} will arm and take off now.` : `${who(vehicle)} is armed and will take off now.`;
  const clear = flies ? [] : ["People and things have to be clear of it."];
  return { title: flies ? `Let ${vehicle.name} fly its mission?` : arms ? `Arm ${vehicle.name} and take off?` : `Take off with ${vehicle.name}?`, lines: [moves, ...heldLines(vehicle), ...clear, ...doubts(vehicle)], go: flies ? "Fly the mission" : arms ? "Arm and take off" : "Take off" };
}

/** Title, lines and button of the question before an order. */
export function saying(vehicle: Vehicle, order: Order, seq: number | null): Saying {
  const name = who(vehicle);
  const { armed, mode, type } = vehicle.state;
  const flies = inFlight(vehicle);
  const waits = type === "fixed_wing" ? "circles" : "hovers";
  const lines = ((): string[] => {
    switch (order.name) {
      case "arm":
        return [
          armed ? `${name} is armed already.` : `${name} will arm now: its motors may start.`,
          ...(FLIES_BY_ITSELF.test(mode) ? [`It is in ${mode}: armed in that mode it may take off by itself. The service refuses that.`] : ["It stays where it is until it is told to start."]),
          ...doubts(vehicle),
        ];
      case "pause":
        return [`${name} leaves its line and ${waits} where it is, until it is told to resume.`];
      case "hold":
        return [flies ? `${name} stays where it is now: it ${waits}. It stays in the air.` : `${name} is not in flight: it is put into its holding mode and does not move.`];
      case "resume":
        return [`${name} goes on with the mission from where it left it.`, ...heldLines(vehicle)];
      case "rtl":
        return [flies ? `${name} gives up the mission and flies home now.` : `${name} is not in flight.`, type === "fixed_wing" ? "Over home it circles until it is landed, unless its firmware has it land." : "At home it lands."];
      case "land":
        return [flies ? (type === "fixed_wing" ? `${name} flies to the landing of its mission now and lands there, if its mission has one.` : `${name} comes down and lands where it is NOW.`) : `${name} is not in flight.`];
      case "sensor_off":
        return [`The payload of ${name} is switched off now. What it does not see from here on is a gap. The mission switches it on again at its next pass.`];
      case "disarm":
        return [flies ? `${name} IS IN FLIGHT: its motors would stop. It refuses that as a rule.` : `The motors of ${name} stop.`];
      case "goto_item":
        return [`${name} leaves what it does and goes on with its mission from item ${seq}.`, ...heldLines(vehicle), ...doubts(vehicle)];
      default:
        return [];
    }
  })();
  if (order.name === "start") return startSaying(vehicle);
  if (hearing(vehicle).lost) lines.push("ITS LINK IS LOST: it is sent all the same, and nobody can tell whether it is heard.");
  return { title: `${order.label}: ${vehicle.name}?`, lines, go: order.label };
}
