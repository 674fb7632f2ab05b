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
  coverage: Record<string, number>;
  planning_time_s: Record<string, number>;
}

export interface PlanRecord {
  id: string;
  name?: string | null;
  state: PlanState;
  stage?: string | null;
  progress?: number;
  metrics?: Metrics | null;
  error?: Problem | string | null;
  created_at?: string;
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

export interface PlanCollection extends FeatureCollection<Geometry, Record<string, unknown>> {
  name?: string;
  metrics: Metrics;
  violations: Violation[];
  methods?: Record<string, string>;
  altitude_m?: number;
  scenario_hash?: string;
  planner_version?: string;
  seed?: number;
}

export interface VehicleState {
  lon_deg?: number | null;
  lat_deg?: number | null;
  relative_m?: number | null;
  heading_deg?: number | null;
  armed?: boolean | null;
  mode?: string | null;
  groundspeed_m_s?: number | null;
  mission_current?: number | null;
  sensor_on?: boolean | null;
  [field: string]: unknown;
}

export interface VehicleRecord {
  id: string;
  name?: string;
  url?: string;
  autopilot?: string | null;
  link?: string | null;
  state?: VehicleState | string | null;
  [field: string]: unknown;
}
