"""Refusals are problem documents, whatever is sent."""

from __future__ import annotations

import json
from collections.abc import AsyncIterator
from pathlib import Path

import httpx
import pytest
import pytest_asyncio

from app.main import create_app
from app.settings import Settings
from tests.app.conftest import fake_house, serving

PLANS = "/api/v1/plans"

pytestmark = pytest.mark.asyncio(loop_scope="module")


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def client(tmp_path_factory: pytest.TempPathFactory) -> AsyncIterator[httpx.AsyncClient]:
    """A client of one service for all of this module: no refusal may harm it."""
    folder = tmp_path_factory.mktemp("problems")
    settings = Settings(database=folder / "plans.db", workers=1, static_dir=folder, log_level="error")
    async with serving(create_app(settings, fake_house)) as client:
        yield client


def check_problem(answer: httpx.Response, status: int, rule: str | None = None) -> None:
    """A problem document with its members, naming a rule."""
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    body = answer.json()
    assert body["status"] == status
    assert body["type"].startswith("urn:problem-type:swathplan:")
    assert all(body[name] for name in ("title", "detail", "instance"))
    if rule is not None:
        assert rule in {entry["rule"] for entry in body["errors"]}
        assert all(entry[name] for entry in body["errors"] for name in ("feature", "rule", "message", "fix"))


@pytest.mark.parametrize(
    ("body", "rule"),
    [
        (b"", "json-syntax"),
        (b"{", "json-syntax"),
        (b"[]", "not-an-object"),
        (b"null", "not-an-object"),
        (b"\xff\xfe", "json-encoding"),
        (b'{"altitude_m": NaN}', "not-a-number"),
        (b'{"altitude_m": -Infinity}', "not-a-number"),
        (b'{"altitude_m": 1e999}', "not-a-number"),
        (b'{"seed": ' + b"9" * 5000 + b"}", "not-a-number"),
        (b'{"name": "\\ud800"}', "json-encoding"),
        (b'{"a":' * 100_000, "json-depth"),
        (b'{"a":' * 100 + b"1" + b"}" * 100, "json-depth"),
        (b'{"name": "a", "name": "b"}', "name-repeated"),
        (b'{"type": "FeatureCollection", "features": []}', "no-positions"),
        (b'{"name": "' + b"x" * 10_000_000 + b'"}', "body-too-large"),
    ],
    ids=lambda value: None if isinstance(value, bytes) else value,
)
@pytest.mark.parametrize("path", [PLANS, "/api/v1/scenarios/validate"])
async def test_bad_bodies_are_422(client: httpx.AsyncClient, path: str, body: bytes, rule: str) -> None:
    """Every malformed or refused body is a 422 that names the rule, and the service goes on."""
    check_problem(await client.post(path, content=body), 422, rule)
    assert (await client.get("/health/live")).status_code == 200


async def test_detail_names_the_feature(client: httpx.AsyncClient) -> None:
    """A single finding is told in the detail together with the feature it is about."""
    answer = await client.post(PLANS, content=b'{"type": "FeatureCollection", "features": []}')
    body = answer.json()
    (entry,) = body["errors"]
    assert body["detail"] == f"the scenario is refused: {entry['feature']}: {entry['message']}"


@pytest.mark.parametrize(
    ("method", "path", "status"),
    [
        ("GET", "/api/v1/nothing", 404),
        ("GET", PLANS + "/no-such", 404),
        ("GET", PLANS + "/no-such/events", 404),
        ("GET", PLANS + "/no-such/plan.geojson", 404),
        ("DELETE", PLANS + "/no-such", 404),
        ("PATCH", PLANS, 405),
        ("GET", PLANS + "?limit=0", 422),
        ("GET", PLANS + "?limit=x", 422),
        ("GET", PLANS + "?state=odd", 422),
        ("POST", PLANS + "?wait=nan", 422),
    ],
)
async def test_other_refusals_are_problems(
    client: httpx.AsyncClient, method: str, path: str, status: int
) -> None:
    """Unknown places, wrong methods and wrong parameters are problem documents too."""
    check_problem(await client.request(method, path), status)


async def test_validate_answers_warnings(client: httpx.AsyncClient) -> None:
    """A sound scenario is valid; what is worth knowing is told and nothing is planned."""
    answer = await client.post("/api/v1/scenarios/validate", content=json.dumps({"features": [{}]}))
    assert answer.status_code == 200
    assert [finding["rule"] for finding in answer.json()["findings"]] == ["no-name"]
    assert (await client.get(PLANS)).json()["total"] == 0


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({"host": "evil.example"}, 421),
        ({"origin": "https://evil.example"}, 403),
        ({"origin": "null"}, 403),
        ({"origin": "http://[bad"}, 403),
        ({"origin": "http://[::1]:99999"}, 403),
        ({"origin": "file://localhost"}, 403),
        # Another service of this machine: its pages must not command aircraft.
        ({"host": "localhost:8000", "origin": "http://localhost:5173"}, 403),
        ({"host": "localhost:8000", "origin": "http://localhost"}, 403),
        ({"host": "localhost:8000", "origin": "http://127.0.0.1:8000"}, 403),
        ({"host": "localhost:8000", "origin": "http://localhost:8000.evil.example"}, 403),
        ({"host": "localhost:8000", "origin": "http://localhost:8000"}, 200),
        ({"host": "LOCALHOST:8000", "origin": "http://localhost:8000"}, 200),
        ({"host": "[::1]:8000", "origin": "http://[::1]:8000"}, 200),
        # Behind a proxy that speaks TLS and keeps the Host header.
        ({"host": "localhost", "origin": "https://localhost"}, 200),
        ({"host": "localhost", "origin": "https://localhost:443"}, 200),
        ({"host": "127.0.0.1:8000"}, 200),
        ({"host": "[::1]:8000"}, 200),
        ({"host": "[::1:8000"}, 421),
    ],
)
async def test_other_sites_are_kept_out(
    client: httpx.AsyncClient, headers: dict[str, str], status: int
) -> None:
    """Requests that another web page could have made the browser send are refused."""
    answer = await client.get(PLANS, headers=headers)
    if status == 200:
        assert answer.status_code == 200
    else:
        check_problem(answer, status)


async def test_a_page_of_another_local_service_commands_nothing(client: httpx.AsyncClient) -> None:
    """A form a browser posts without asking first, from another port of this machine, reaches no vehicle."""
    page = {"host": "localhost:8000", "origin": "http://localhost:3000", "content-type": "text/plain"}
    command = "/api/v1/vehicles/some/commands"
    answer = await client.post(command, headers=page, content='{"command": "arm"}')
    check_problem(answer, 403, "origin-unknown")
    assert "http://localhost:3000" in answer.json()["detail"]
    check_problem(await client.post(command, headers=page | {"origin": "http://localhost:8000"}), 422)


async def test_origins_that_are_allowed(settings: Settings) -> None:
    """A page whose origin is listed may use the service; one of the same host but another port may not."""
    allowed = settings.model_copy(update={"allowed_origins": ("https://ops.example:8443",)})
    async with serving(create_app(allowed, fake_house)) as client:
        for origin, status in (("https://OPS.example:8443", 200), ("https://ops.example", 403)):
            assert (await client.get(PLANS, headers={"origin": origin})).status_code == status


async def test_unforeseen_error_is_a_bare_500(
    client: httpx.AsyncClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What nobody foresaw is a 500 that tells nothing of the inside but the request id."""

    async def broken(*_: object) -> None:
        raise RuntimeError("a secret of the inside")

    monkeypatch.setattr("app.services.plans.planning.PlanningService.get", broken)
    answer = await client.get(PLANS + "/x", headers={"X-Request-ID": "abc"})
    check_problem(answer, 500)
    assert "secret" not in answer.text
    assert answer.headers["x-request-id"] == "abc"


async def test_listening_beyond_this_machine_needs_a_word() -> None:
    """An address others can reach is refused unless it is allowed in so many words."""
    with pytest.raises(ValueError, match="no users"):
        Settings(host="0.0.0.0")
    assert Settings(host="0.0.0.0", allow_remote=True).host == "0.0.0.0"


async def test_map_does_not_hide_the_interface(settings: Settings, tmp_path: Path) -> None:
    """With a built map at the root, paths and methods of the interface are refused as they are without."""
    (tmp_path / "index.html").write_text("<title>map</title>")
    async with serving(create_app(settings, fake_house)) as client:
        assert "<title>map</title>" in (await client.get("/")).text
        check_problem(await client.get("/no-such-file"), 404)
        nothing = await client.get("/api/v1/nothing")
        check_problem(nothing, 404)
        assert "/docs" in nothing.json()["detail"]
        check_problem(await client.patch("/api/v1/scenarios/validate"), 405)
        check_problem(await client.patch(PLANS), 405)
        check_problem(await client.post("/health/live"), 405)
