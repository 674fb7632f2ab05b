"""The planning library by itself: a scenario in, a plan and a QGroundControl file out."""

import json
import sys
from pathlib import Path

from mavlink.encoding.encode import encode
from mavlink.formats.qgc_plan import write_plan as write_qgc_plan
from planner.errors import PlannerError
from planner.geojson import read_scenario, write_plan
from planner.pipeline import make_plan

scenario_file = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent / "sar-case-1.geojson")
out = Path(sys.argv[2] if len(sys.argv) > 2 else ".")

try:
    scenario = read_scenario(json.loads(scenario_file.read_text()))
    plan = make_plan(
        scenario, progress=lambda stage, fraction: print(f"{fraction:4.0%} {stage}", file=sys.stderr)
    )
except PlannerError as error:
    sys.exit(f"no plan: {error}")

print(
    f"{plan.metrics.length_m / 1000:.2f} km, {plan.metrics.turns} turns, violations: {len(plan.violations)}"
)
for name, fraction in plan.metrics.coverage.items():
    print(f"{name}: {fraction:.2%} seen")

(out / "plan.geojson").write_text(json.dumps(write_plan(plan)))
(out / "mission.plan").write_text(write_qgc_plan(encode(plan)))
