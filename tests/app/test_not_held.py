"""An upload's status says whether the vehicle holds what was meant."""

from __future__ import annotations

import httpx
import pytest

from mavlink.sim.settings import SimSettings
from tests.app.small_flight import order
from tests.app.test_problems import check_problem
from tests.app.test_vehicles import faulty_vehicle
from tests.patience import PATIENCE_S


@pytest.mark.parametrize(
    ("fault", "outcome", "rule"),
    [("error_ack_at_0", "refused", "upload-refused"), ("altered_item", "different", "upload-differs")],
)
async def test_what_is_not_held_is_no_success(
    client: httpx.AsyncClient, plan_id: str, fault: str, outcome: str, rule: str
) -> None:
    """A refusal, and a list that reads back otherwise, are problems that tell all that an answer tells."""
    async with faulty_vehicle(client, SimSettings(faults=(fault,))) as vehicle:
        body = {"plan_id": plan_id, "parts": ["mission"]}
        answer = await client.post(vehicle + "/mission", json=body, timeout=PATIENCE_S)
        check_problem(answer, 409, rule)
        problem = answer.json()
        assert problem["type"].endswith(":not-held")
        assert (problem["outcome"], problem["verified"]) == (outcome, False)
        assert [error["feature"] for error in problem["errors"]] == ["mission"]
        assert problem["parts"]["mission"]["meant"] > 0
        assert problem["number"] == (await client.get(vehicle)).json()["upload"]["number"]
        ordered = (await client.get("/api/v1/audit", params={"kind": "upload"})).json()["entries"][0]
        assert ordered["outcome"] == outcome
        if outcome == "different":
            check_problem(await order(client, vehicle, "arm"), 409, "mission-differs")


async def test_what_could_not_be_read_back_is_not_known_to_be_held(
    client: httpx.AsyncClient, plan_id: str
) -> None:
    """The vehicle said yes and then nothing more: accepted for later, not done."""
    async with faulty_vehicle(client, SimSettings(faults=("no_response_to_list",))) as vehicle:
        body = {"plan_id": plan_id, "parts": ["mission"]}
        answer = await client.post(vehicle + "/mission", json=body, timeout=PATIENCE_S)
        assert (answer.status_code, answer.json()["verified"]) == (202, False), answer.text
        assert answer.json()["parts"]["mission"]["differences"] is None
