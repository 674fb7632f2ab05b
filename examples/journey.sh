#!/bin/sh
# The whole journey with curl: plan a scenario, upload it, fly it, see what was seen.
# Needs a running service (make run), curl and python3.
#
#   sh examples/journey.sh [scenario] [service] [vehicle] [changes]
#
# vehicle  where it is: udpin:127.0.0.1:14550, tcp:…, serial:…; a simulated aircraft when left out
# changes  a JSON file laid over the scenario, as examples/px4.json: what this vehicle is
# JOURNEY_LIMIT_S  how long to wait for the landing, 900 s when not set; JOURNEY_FOLDER  where files go
set -eu
scenario=${1:-$(dirname "$0")/sar-case-1.geojson}
api=${2:-http://127.0.0.1:8000}/api/v1
url=${3:-sim:?speedup=60}
changes=${4:-}
folder=${JOURNEY_FOLDER:-${TMPDIR:-/tmp}}
field() { python3 -c 'import json, sys; print(json.load(sys.stdin)'"$1"')'; }
post() { curl -sS --fail-with-body "$1" -H 'Content-Type: application/json' -d "$2"; }
# A refusal is a problem document that names feature, rule and fix: shown before the end.
stop() { echo "$1"; exit 1; }

curl -fsS "${api%/api/v1}/health/live" >/dev/null ||
    stop "no service answers at ${api%/api/v1}: start it with make run, or name its address"

document=$(python3 - "$scenario" $changes <<'PYTHON'
import json, sys

def over(below, above):
    if isinstance(below, dict) and isinstance(above, dict):
        return below | {key: over(below.get(key), value) for key, value in above.items()}
    if isinstance(below, list) and isinstance(above, list):
        return [over(one, other) for one, other in zip(below, above)] + below[len(above):] + above[len(below):]
    return above

scenario, *changes = (json.load(open(name, encoding="utf-8")) for name in sys.argv[1:])
for change in changes:
    scenario = over(scenario, change)
print(json.dumps(scenario))
PYTHON
)
verdict=$(echo "$document" | curl -sS --fail-with-body "$api/scenarios/validate" --data-binary @-) ||
    stop "validate: $verdict"
echo "validate: $verdict"

plan=$(echo "$document" | curl -sS --fail-with-body "$api/plans?wait=300" --data-binary @-) || stop "plan: $plan"
plan_id=$(echo "$plan" | field '["id"]')
[ "$(echo "$plan" | field '["state"]')" = done ] || stop "plan: $plan"
echo "plan $plan_id: $(echo "$plan" | field '["metrics"]["length_m"]') m"
curl -fsS "$api/plans/$plan_id/mission.plan" -o "$folder/swathplan-mission.plan"

vehicle=$(post "$api/vehicles" "{\"name\": \"journey\", \"url\": \"$url\", \"timeout_s\": 60}") ||
    stop "vehicle: $vehicle"
vehicle_id=$(echo "$vehicle" | field '["id"]')
trap 'curl -fsS -X DELETE "$api/vehicles/$vehicle_id" >/dev/null || true' EXIT
[ "$(echo "$vehicle" | field '["connected"]')" = True ] || { echo "vehicle: nobody is heard at $url"; exit 1; }
echo "vehicle: $(echo "$vehicle" | field '["state"]["autopilot"]') $(echo "$vehicle" | field '["state"]["type"]')"

parts='["mission", "fence"]'
upload=$(post "$api/vehicles/$vehicle_id/mission" "{\"plan_id\": \"$plan_id\", \"parts\": $parts}") || {
    echo "upload: $upload"
    exit 1
}
echo "upload: $(echo "$upload" | field '["outcome"]'), read back equal: $(echo "$upload" | field '["verified"]')"
[ "$(echo "$upload" | field '["verified"]')" = True ] || exit 1

# A vehicle that has just started refuses to arm until its position and attitude have settled.
for try in $(seq 60); do
    if refusal=$(post "$api/vehicles/$vehicle_id/commands" '{"command": "arm"}'); then break; fi
    [ "$try" -lt 60 ] || { echo "arm: $refusal"; exit 1; }
    sleep 1
done
echo "arm: done"
started=$(post "$api/vehicles/$vehicle_id/commands" '{"command": "start"}') || { echo "start: $started"; exit 1; }
echo "start: done"

# Watch until the aircraft has landed or circles over home.
flight_id=
landed=
for _ in $(seq "${JOURNEY_LIMIT_S:-900}"); do
    sleep 1
    state=$(curl -fsS "$api/vehicles/$vehicle_id")
    flight_id=${flight_id:-$(echo "$state" | field '.get("flight_id") or ""')}
    mode=$(echo "$state" | field '["state"]["mode"]')
    armed=$(echo "$state" | field '["state"]["armed"]')
    printf '\r%s, item %s   ' "$mode" "$(echo "$state" | field '["state"]["mission_current"]')"
    if [ -n "$flight_id" ] && { [ "$armed" = False ] || [ "$mode" = RTL ]; }; then landed=$armed; break; fi
done
echo
case $landed in
    False) echo "landed, disarmed" ;;
    True) echo "back over home, circling: the landing is the pilot's" ;;
    *) echo "still flying after ${JOURNEY_LIMIT_S:-900} s: $mode"; exit 1 ;;
esac
curl -fsS "$api/flights/$flight_id/coverage.geojson" -o "$folder/swathplan-coverage.geojson"
curl -fsS "$api/flights/$flight_id/report.html" -o "$folder/swathplan-report.html"
echo "report: $folder/swathplan-report.html"
python3 - "$folder/swathplan-coverage.geojson" <<'PYTHON'
import json, sys

flown = json.load(open(sys.argv[1], encoding="utf-8"))
for one in flown["collects"]:
    print(f"pass {one['seq']}, {one['roi']}: {one['cross_track_p95_m']:.1f} m off the line (p95), "
          f"{one['cross_track_max_m']:.1f} m at most")
print("seen:", flown["coverage"])
PYTHON
