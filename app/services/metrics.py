"""What Prometheus is told."""

from __future__ import annotations

from collections.abc import Iterator

from prometheus_client import REGISTRY, CollectorRegistry, Counter, Gauge, Histogram, Metric, generate_latest
from prometheus_client.parser import text_string_to_metric_families
from prometheus_client.registry import Collector

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

#: What the names of all of these begin with.
_OURS = "swathplan_"


def exposition(other: str = "") -> bytes:
    """Figures in Prometheus' text format: this process's, and those of a process that stands for it, too."""
    registry = CollectorRegistry()
    registry.register(_Together(other))
    return generate_latest(registry)


class _Together(Collector):
    """Figures of this process, and of ours in another one's text; those of one name and label are added."""

    def __init__(self, other: str) -> None:
        self._other = other

    def collect(self) -> Iterator[Metric]:
        """All families, each once."""
        theirs: dict[tuple[str, tuple[tuple[str, str], ...]], float] = {}
        families = {family.name: family for family in REGISTRY.collect()}
        for family in text_string_to_metric_families(self._other):
            if not family.name.startswith(_OURS) or family.name not in families:
                continue
            for sample in family.samples:
                theirs[sample.name, tuple(sorted(sample.labels.items()))] = sample.value
            own = families[family.name]
            both = Metric(own.name, own.documentation, own.type)
            for sample in own.samples:
                key = sample.name, tuple(sorted(sample.labels.items()))
                more = theirs.pop(key, 0.0) if not sample.name.endswith("_created") else 0.0
                both.add_sample(sample.name, sample.labels, sample.value + more)
            for (name, labels), value in theirs.items():
                both.add_sample(name, dict(labels), value)
            theirs.clear()
            families[family.name] = both
        yield from families.values()
