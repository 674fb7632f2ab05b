"""Parameters that must be right for a mission to be flown as planned. Read and reported; never set.

Each rule names the parameters it reads, says when it applies, and judges their values by what the plan needs.
``RULES`` is the table, by autopilot and type of vehicle; the rules stand in ``mavlink.rules``.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import Final

from mavlink.dialects import Autopilot, VehicleType
from mavlink.rules import ardupilot, px4
from mavlink.rules.base import OTHER_NAMES, Needs, ParameterFinding, Rule, Values, needs_of

__all__ = [
    "RULES",
    "Needs",
    "ParameterFinding",
    "judge_parameters",
    "names_to_read",
    "needs_of",
    "unanswered",
]

#: Rules by autopilot and type of vehicle.
RULES: Final[dict[tuple[Autopilot, VehicleType], tuple[Rule, ...]]] = {
    ("ardupilot", "fixed_wing"): ardupilot.PLANE,
    ("ardupilot", "vtol"): ardupilot.VTOL,
    ("ardupilot", "multirotor"): ardupilot.COPTER,
    ("px4", "fixed_wing"): px4.FIXED_WING,
    ("px4", "vtol"): px4.VTOL,
    ("px4", "multirotor"): px4.MULTIROTOR,
}


def names_to_read(autopilot: Autopilot, vehicle_type: VehicleType, needs: Needs) -> tuple[str, ...]:
    """Parameters to ask a vehicle for, in the order of the table."""
    names = (name for rule in _rules(autopilot, vehicle_type, needs) for name in rule.names(needs))
    return tuple(dict.fromkeys(names))


def unanswered(names: Collection[str], values: Collection[str]) -> tuple[str, ...]:
    """The names that were answered neither as they are nor as other versions have them."""
    missing = (name for name in names if name not in values)
    return tuple(name for name in missing if OTHER_NAMES.get(name, (name,))[0] not in values)


def judge_parameters(
    autopilot: Autopilot, vehicle_type: VehicleType, needs: Needs, values: Values
) -> tuple[ParameterFinding, ...]:
    """What is not as the mission needs it; parameters that were not read are not judged."""
    findings = (rule.judge(values, needs) for rule in _rules(autopilot, vehicle_type, needs))
    return tuple(finding for finding in findings if finding is not None)


def _rules(autopilot: Autopilot, vehicle_type: VehicleType, needs: Needs) -> tuple[Rule, ...]:
    return tuple(rule for rule in RULES[autopilot, vehicle_type] if rule.applies(needs))
