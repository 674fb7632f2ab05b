#!/bin/sh
# The whole journey with curl: plan a scenario, upload it, fly it, see what was seen.
# Needs a running service (make run) and curl.   sh examples/journey.sh [scenario] [service]
set -eu
scenario=${1:-$(dirname "$0")/sar-case-1.geojson}
api=${2:-http://127.0.0.1:8000}/api/v1
field() { python3 -c 'import json, sys; print(json.load(sys.stdin)'"$1"')'; }

echo "validate: $(curl -fsS "$api/scenarios/validate" --data-binary "@$scenario")"

plan=$(curl -fsS "$api/plans?wait=60" --data-binary "@$scenario")
plan_id=$(echo "$plan" | field '["id"]')
echo "plan $plan_id: $(echo "$plan" | field '["metrics"]["length_m"]') m"
curl -fsS "$api/plans/$plan_id/mission.plan" -o "${TMPDIR:-/tmp}/swathplan-mission.plan"

vehicle=$(curl -fsS "$api/vehicles" -H 'Content-Type: application/json' \
    -d "{\"name\": \"journey\", \"url\": \"sim:?speedup=60\"}")
vehicle_id=$(echo "$vehicle" | field '["id"]')

upload=$(curl -fsS "$api/vehicles/$vehicle_id/mission" -H 'Content-Type: application/json' \
    -d "{\"plan_id\": \"$plan_id\", \"parts\": [\"mission\", \"fence\"]}")
echo "upload: $(echo "$upload" | field '["outcome"]'), read back equal: $(echo "$upload" | field '["verified"]')"

for command in arm start; do
    curl -fsS "$api/vehicles/$vehicle_id/commands" -H 'Content-Type: application/json' \
        -d "{\"command\": \"$command\"}" >/dev/null
    echo "$command: done"
done

# Watch until the aircraft has landed or circles over home.
flight_id=
for _ in $(seq 120); do
    sleep 1
    state=$(curl -fsS "$api/vehicles/$vehicle_id")
    flight_id=${flight_id:-$(echo "$state" | field '.get("flight_id") or ""')}
    mode=$(echo "$state" | field '["state"]["mode"]')
    armed=$(echo "$state" | field '["state"]["armed"]')
    printf '\r%s, item %s   ' "$mode" "$(echo "$state" | field '["state"]["mission_current"]')"
    if [ "$armed" = False ] || [ "$mode" = RTL ]; then break; fi
done
echo
echo "seen: $(curl -fsS "$api/flights/$flight_id/coverage.geojson" | field '["coverage"]')"
curl -fsS -X DELETE "$api/vehicles/$vehicle_id" >/dev/null
