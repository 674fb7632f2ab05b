/** What a plan leaves open of its mission: how the payload is switched and pointed. */
import { h, section } from "../dom";
import { encoding } from "../encoding";

/** Ways to switch the sensor, to be filled in; the first is what an empty field means, but for cameras. */
const SWITCHES = ["relay:0", "servo:9:1900:1100", "trigger:distance", "trigger:time", "camera:distance=25", "image:interval=2", "actuator:1", "aux:1"];
const SWITCHED = "What the autopilot switches at both ends of every pass. trigger:distance or trigger:time takes a camera's photos as far apart as planned · relay:number · servo:output:on:off in µs · camera:distance=metres between photos · image:interval=seconds · PX4: actuator:number, aux:output or main:output · command:number:parameters";

/** Gimbals, to be filled in; an empty field means none. */
const GIMBALS = ["none", "manager:tilt=45", "manager:tilt=45,yaw=course", "mount:tilt=45"];
const POINTED = "A gimbal that points the sensor to the side each pass looks to. tilt=degrees from straight down · yaw=vehicle turns with the nose, yaw=course is held abeam · device=number · mount for older firmware";

export function encodingFields(): HTMLElement {
  const payload = h("input", { id: "payload", type: "text", list: "payloads", placeholder: "as planned", maxlength: 200, autocomplete: "off", spellcheck: "false", "aria-describedby": "payload-hint" });
  const gimbal = h("input", { id: "gimbal", type: "text", list: "gimbals", placeholder: GIMBALS[0], maxlength: 200, autocomplete: "off", spellcheck: "false", "aria-describedby": "gimbal-hint" });
  const take = (): void => encoding.set({ payload: payload.value.trim() || null, gimbal: gimbal.value.trim() || null });
  for (const field of [payload, gimbal]) field.addEventListener("change", take);
  return section(
    "Payload: how it is switched and pointed",
    false,
    h("div", { class: "field" }, h("label", { for: "payload" }, `Output or command (when empty: a camera by its own trigger, all else ${SWITCHES[0]})`), payload),
    h("datalist", { id: "payloads" }, ...SWITCHES.map((value) => h("option", { value }))),
    h("p", { class: "quiet", id: "payload-hint" }, SWITCHED),
    h("div", { class: "field" }, h("label", { for: "gimbal" }, "Gimbal (bolted on when empty)"), gimbal),
    h("datalist", { id: "gimbals" }, ...GIMBALS.map((value) => h("option", { value }))),
    h("p", { class: "quiet", id: "gimbal-hint" }, POINTED),
  );
}
