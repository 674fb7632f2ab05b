"""The planner's edge, where everything is validated once: GeoJSON to Scenario, Plan to GeoJSON and back."""

from planner.geojson.plan_reader import read_plan
from planner.geojson.plan_writer import write_plan
from planner.geojson.scenario_reader import read_scenario, scenario_hash

__all__ = ["read_plan", "read_scenario", "scenario_hash", "write_plan"]
