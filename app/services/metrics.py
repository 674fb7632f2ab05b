"""What Prometheus is told."""

from __future__ import annotations

from prometheus_client import Counter, Gauge, Histogram

REQUESTS = Counter("swathplan_requests", "HTTP requests answered.", ["method", "route", "status"])
REQUEST_SECONDS = Histogram("swathplan_request_seconds", "Time to the last byte of an answer.", ["route"])
PLANS_ENDED = Counter("swathplan_plans_ended", "Plans that ended.", ["state"])
PLANS_RUNNING = Gauge("swathplan_plans_running", "Plans being made.")
PLANNING_SECONDS = Histogram(
    "swathplan_planning_seconds",
    "Time a plan spent in a worker.",
    buckets=(0.1, 0.25, 0.5, 1, 2.5, 5, 10, 30, 60, 120, 300, 600),
)
VEHICLES = Gauge("swathplan_vehicles", "Vehicles known.", ["state"])
UPLOADS = Counter("swathplan_uploads", "Uploads to vehicles.", ["outcome"])
