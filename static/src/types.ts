/** What travels between the page and the service. */
import type { Feature, FeatureCollection, Geometry } from "geojson";

export type Position = [number, number];

export type Role =
  | "roi"
  | "threat"
  | "no_fly"
  | "obstacle"
  | "area"
  | "start"
  | "end"
  | "base"
  | "importance";

export interface ScenarioProperties {
  role: Role;
  name?: string;
  [property: string]: unknown;
}

export type ScenarioFeature = Feature<Geometry, ScenarioProperties>;

export type Member = Record<string, unknown>;

export interface Scenario extends FeatureCollection<Geometry, ScenarioProperties> {
  name?: string;
  vehicles?: Member[];
  sensors?: Member[];
  altitude_m?: number;
  altitude_reference?: string;
  method?: Record<string, string>;
  objective?: Record<string, number>;
  seed?: number;
  time_budget_s?: number;
  [member: string]: unknown;
}

export interface Finding {
  feature: string;
  rule: string;
  message: string;
  fix: string;
  severity?: "error" | "warning";
  /** The place, where there is one. */
  where?: Position;
}

export interface Problem {
  type?: string;
  title: string;
  status?: number;
  detail?: string;
  errors?: Finding[];
  [member: string]: unknown;
}

export type PlanState = "queued" | "running" | "done" | "failed" | "cancelled";

export interface VehicleMetrics {
  length_m: number;
  duration_s: number;
  energy_wh: number | null;
  priority: number;
  sorties?: number;
  take_off_s?: number;
  landing_s?: number;
}

export interface Metrics {
  length_m: number;
  collection_length_m: number;
  duty_cycle: number;
  path_length_ratio: number | null;
  risk_missile: number;
  risk_radar: number;
  turns: number;
  duration_s: number;
  energy_wh: number | null;
  /** Of the whole flight, take-off to landing; absent in plans of the mission alone. */
  flight_length_m?: number | null;
  flight_duration_s?: number | null;
  coverage: Record<string, number>;
  planning_time_s: Record<string, number>;
  lower_bound_m?: number | null;
  gap?: number | null;
  photos?: number | null;
  /** Of each aircraft of a plan of several. */
  vehicles?: Record<string, VehicleMetrics>;
  /** Of a plan made in flight: what of the order before it is kept. */
  replan?: { begins_in_s: number; kept: string[]; moved: string[]; new: string[] };
  left_out?: { roi: string; reason: string; margin: number | null }[];
  last_landing_s?: number | null;
  /** Of a search: ground seen, each place once, and what that is worth where importance is given. */
  area_seen_m2?: number | null;
  importance_collected?: number | null;
  importance_total?: number | null;
  /** What no flight sees or collects more than. */
  area_seen_bound_m2?: number | null;
  importance_bound?: number | null;
}

export interface PlanRecord {
  id: string;
  name?: string | null;
  state: PlanState;
  stage?: string | null;
  progress?: number;
  metrics?: Metrics | null;
  error?: Problem | string | null;
  warnings?: Finding[];
  created_at?: string;
  started_at?: string | null;
  /** The kept scenario it was made of, and whether that one is another by now; null: not known. */
  scenario_id?: string | null;
  stale?: boolean | null;
  stale_reason?: string | null;
}

export type PhaseKind = "take_off" | "climb" | "mission" | "return" | "landing";

export interface Phase {
  kind: PhaseKind;
  start_m: number;
  end_m: number;
  start_s: number;
  end_s: number;
}

/** A scenario the service keeps. */
export interface KeptRecord {
  id: string;
  name: string | null;
  revision: number;
  scenario_hash: string;
  changed_at: string;
}

export interface KeptText extends KeptRecord {
  scenario: Scenario;
}

export interface Violation {
  constraint: string;
  feature: string;
  message: string;
  amount: number;
  unit: string;
  where: Position | null;
  hard: boolean;
}

export interface PlanCamera {
  name: string;
  focal_length_m: number;
  pixel_pitch_m: number;
  /** Across and along the flight direction. */
  columns: number;
  rows: number;
  forward_overlap: number;
  side_overlap: number;
  tilt_deg: number;
  min_interval_s: number;
  trigger: "distance" | "time" | "video";
  model: string | null;
  spectrum: "visible" | "infrared";
}

export interface PlanVehicle {
  name: string;
  type: "fixed_wing" | "multirotor" | "vtol";
  airspeed_m_s: number;
}

export interface PlanCollection extends FeatureCollection<Geometry, Record<string, unknown>> {
  name?: string;
  metrics: Metrics;
  violations: Violation[];
  methods?: Record<string, string>;
  vehicles?: PlanVehicle[];
  cameras?: PlanCamera[];
  wind?: { speed_m_s: number; from_deg: number };
  altitude_m?: number;
  altitude_reference?: "amsl" | "home" | "terrain";
  scenario_hash?: string;
  planner_version?: string;
  seed?: number;
}

export interface VehicleState {
  connected: boolean;
  /** The vehicle's own time since boot. */
  time_s: number | null;
  armed: boolean;
  mode: string;
  autopilot: string;
  type: string;
  landed: boolean | null;
  lon_deg: number | null;
  lat_deg: number | null;
  altitude_amsl_m: number | null;
  relative_altitude_m: number | null;
  heading_deg: number | null;
  roll_deg: number | null;
  ground_speed_m_s: number | null;
  airspeed_m_s: number | null;
  battery_percent: number | null;
  battery_voltage_v: number | null;
  gps_fix: string | null;
  satellites: number | null;
  home_lon_deg: number | null;
  home_lat_deg: number | null;
  mission_current: number | null;
  mission_total: number | null;
  mission_state: string | null;
  sensor_on: boolean | null;
  texts: { severity: number; text: string }[];
}

export interface Preflight {
  plan_id: string;
  ready: boolean;
  checks: { name: string; status: "ok" | "warning" | "failed"; detail: string }[];
  parameters: { name: string; value: number | null; advised: number | null; reason: string; severity: "error" | "warning" }[];
}

export type UploadOutcome = "accepted" | "different" | "refused" | "unknown" | "not_attempted";

export interface Upload {
  number: number;
  plan_id: string;
  plan_vehicle?: string;
  outcome: UploadOutcome;
  verified: boolean;
  parts: Record<
    string,
    { outcome: UploadOutcome; reason: string; verified: boolean; meant: number; differences: { message: string }[] | null }
  >;
  findings: Finding[];
  notes: string[];
  override_reason: string | null;
  preflight: Preflight | null;
  /** Of a mission replaced in flight: where the aircraft goes on, and what it skips. */
  in_flight?: { message: string; item: number | null } | null;
}

/** What the service knows of the mission last sent to a vehicle. */
export interface Sent {
  plan_id: string;
  standing: "held" | "differs" | "unknown";
  shown_by: "read_back" | "id" | null;
  read_back_at: string | null;
}

export type Part = "mission" | "fence" | "rally";

export interface HeldItem {
  seq: number;
  command: number;
  command_name: string | null;
  params?: (number | null)[];
  lat_deg?: number;
  lon_deg?: number;
  altitude_m: number | null;
}

export interface Recording {
  name: string;
  size_bytes: number;
  ended_at: string;
  url: string;
}

export interface Vehicle {
  id: string;
  name: string;
  url: string;
  connected: boolean;
  /** Its MAVLink system, and another one that answers in its place while it is silent. */
  system_id: number | null;
  other_system: number | null;
  /** Where it is heard from on a port where anybody may speak, who else speaks there, and what is doubted of it. */
  address: string | null;
  strangers: string[];
  namesakes: string[];
  doubt: { rule: string; message: string; fix: string } | null;
  signing: string | null;
  link_failure: string | null;
  simulated: boolean;
  replay: boolean;
  operation: string | null;
  transfer: { part: string; done: number; total: number } | null;
  pending: boolean;
  plan_id: string | null;
  sent: Sent | null;
  /** Whether the mission it holds has a landing; null where that is not known. */
  mission_lands: boolean | null;
  flight_id: string | null;
  upload: Upload | null;
  state: VehicleState;
  /** How old the position is, how good the link, whether the payload is on: null where nobody can tell. */
  position_age_s?: number | null;
  link?: { quality: number | null; lost: boolean; lost_since: string | null };
  sensor?: { on: boolean | null; since_s: number | null };
}

export interface Flight {
  id: string;
  vehicle_id: string;
  vehicle_name: string;
  plan_id: string | null;
  state: "flying" | "ended" | "interrupted";
  started_at: string;
  ended_at: string | null;
  points: number;
}

/** Of a camera's flight; shares are parts of a photo, or of the region. */
export interface SeenPhotos {
  taken: number;
  counted: number;
  not_counted: Record<string, number>;
  /** Where an autopilot reports none: as many as planned along the line flown. */
  assumed: number;
  passes: { seq: number; planned: number; taken: number; missing: number }[];
  regions: {
    roi: string;
    gsd_limit_m: number | null;
    gsd_worst_m: number | null;
    gsd_mean_m: number | null;
    overlap_photos: number;
    overlap_fraction: number | null;
    planned_overlap_fraction: number | null;
    forward_overlap: { least: number | null; mean: number | null };
    side_overlap: { least: number | null; mean: number | null };
  }[];
}

export interface SeenCollection extends FeatureCollection<Geometry, Record<string, unknown>> {
  /** Null where several flights are judged together. */
  flight: string | null;
  flights: string[];
  plan: string;
  coverage: Record<string, number>;
  unknown_coverage: Record<string, number>;
  gaps: { flight: string; start_at: string; end_at: string | null; duration_s: number | null }[];
  not_counted: { length_m: number; reason: string; why: string }[];
  energy: { flight: string; planned_wh: number | null; drawn_wh: number | null; complete: boolean | null }[];
  planned_coverage: Record<string, number>;
  seen_fraction: number;
  photos?: SeenPhotos | null;
  regions: { roi: string; seen: boolean }[];
  collects: { seq: number; roi: string; cross_track_p95_m: number; cross_track_max_m: number; sensor_on_m: number }[];
}
