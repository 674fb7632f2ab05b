#!/bin/sh
# The whole journey against a real autopilot in its own simulator, with one command:
#
#   sh docker/journey.sh ardupilot|px4            in containers, put up for it and taken down after it
#   sh docker/journey.sh ardupilot|px4 ADDRESS    with a service (SERVICE, http://127.0.0.1:8000) and a simulator
#                                                 that run here already; it calls ADDRESS: udpin:127.0.0.1:14551
#
# SCENARIO  what to fly, examples/sar-case-1.geojson when not set; SPEEDUP  of the containers, 10 (PX4: 5)
set -eu
case ${1:-} in
    ardupilot) calls=udpin:127.0.0.1:14551 ;;
    px4) calls=udpin:127.0.0.1:14550 ;;
    *) echo "usage: sh docker/journey.sh ardupilot|px4 [address]" >&2; exit 2 ;;
esac
here=$(cd "$(dirname "$0")" && pwd)
examples=$here/../examples
service=${SERVICE:-http://127.0.0.1:8000}
if [ $# -lt 2 ]; then
    compose="docker compose -f $here/compose.yml --profile $1"
    trap '$compose down' EXIT
    $compose up --build --detach
fi
for _ in $(seq 120); do
    if curl -fsS "$service/health/ready" >/dev/null 2>&1; then break; fi
    sleep 1
done
sh "$examples/journey.sh" "${SCENARIO:-$examples/sar-case-1.geojson}" "$service" "${2:-$calls}" "$examples/$1.json"
