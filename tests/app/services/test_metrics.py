"""Figures of two processes as one: each name once, each label once."""

from __future__ import annotations

from prometheus_client.parser import text_string_to_metric_families

from app.services.metrics import REQUEST_SECONDS, REQUESTS, exposition

OTHER = """# HELP swathplan_vehicles Vehicles known.
# TYPE swathplan_vehicles gauge
swathplan_vehicles{state="connected"} 3.0
# HELP swathplan_requests_total HTTP requests answered.
# TYPE swathplan_requests_total counter
swathplan_requests_total{method="GET",route="/both",status="200"} 5.0
swathplan_requests_total{method="GET",route="/theirs",status="200"} 2.0
# HELP process_cpu_seconds_total Total user and system CPU time spent in seconds.
# TYPE process_cpu_seconds_total counter
process_cpu_seconds_total 1e+09
# HELP swathplan_request_seconds Time to the last byte of an answer.
# TYPE swathplan_request_seconds histogram
swathplan_request_seconds_bucket{le="+Inf",route="/theirs"} 2.0
swathplan_request_seconds_count{route="/theirs"} 2.0
swathplan_request_seconds_sum{route="/theirs"} 0.5
"""


def figures(text: str) -> dict[str, float]:
    """Values by name and labels; each must be there once."""
    found: dict[str, float] = {}
    families = [family.name for family in text_string_to_metric_families(text)]
    assert len(families) == len(set(families))
    for family in text_string_to_metric_families(text):
        for sample in family.samples:
            key = f"{sample.name}{sorted(sample.labels.items())}"
            assert key not in found
            found[key] = sample.value
    return found


def test_figures_of_both_are_told_and_those_of_one_name_added() -> None:
    """Ours grow by theirs, theirs alone are there, and those of the process itself stay this one's."""
    REQUESTS.labels(method="GET", route="/both", status="200").inc(4)
    REQUEST_SECONDS.labels(route="/both").observe(0.1)
    alone, both = figures(exposition().decode()), figures(exposition(OTHER).decode())
    requests = "swathplan_requests_total[('method', 'GET'), ('route', '/{}'), ('status', '200')]"
    assert both[requests.format("both")] == alone[requests.format("both")] + 5.0
    assert both[requests.format("theirs")] == 2.0
    vehicles = "swathplan_vehicles[('state', 'connected')]"
    assert both[vehicles] == alone.get(vehicles, 0.0) + 3.0
    assert both["swathplan_request_seconds_count[('route', '/theirs')]"] == 2.0
    assert both["swathplan_request_seconds_count[('route', '/both')]"] >= 1.0
    assert both["process_cpu_seconds_total[]"] < 1e6
    assert set(alone) <= set(both)
