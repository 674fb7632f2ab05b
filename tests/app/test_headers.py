"""What browsers are told not to do with answers, what figures are kept of, whose files the service's are."""

from __future__ import annotations

import stat
import subprocess
import sys
from pathlib import Path

import httpx
import pytest

from app.main import create_app
from app.settings import Settings
from mavlink.links.recording import TlogWriter
from tests.app.cli.conftest import ROOT
from tests.app.conftest import fake_house, serving
from tests.app.test_problems import check_problem
from tests.mavlink.links.test_recording import frames


def directives(answer: httpx.Response) -> dict[str, str]:
    """Parts of an answer's content security policy."""
    parts = answer.headers["content-security-policy"].split(";")
    return {name: rest for name, _, rest in (part.strip().partition(" ") for part in parts)}


async def test_every_answer_has_a_policy(settings: Settings, tmp_path: Path, plan_file: Path) -> None:
    """Answers, refusals, pages: none may be framed or sniffed; only the pages' own scripts run."""
    (tmp_path / "index.html").write_text("<title>map</title>")
    (tmp_path / "a.js").write_text("1")
    async with serving(create_app(settings, fake_house)) as client:
        for path in ("/", "/a.js", "/nothing.js", "/docs", "/api/v1/plans", "/api/v1/nothing", "/metrics"):
            answer = await client.get(path)
            policy = directives(answer)
            assert policy["default-src"] == "'none'", path
            assert policy["frame-ancestors"] == "'none'", path
            assert answer.headers["x-content-type-options"] == "nosniff"
            assert answer.headers["x-frame-options"] == "DENY"
            assert answer.headers["referrer-policy"]
            assert "unsafe" not in policy.get("script-src", "")
        page = await client.get("/")
        assert directives(page)["script-src"] == "'self'"
        described = await client.get("/docs")
        nonce = directives(described)["script-src"].removeprefix("'nonce-").removesuffix("'")
        assert described.text.count("<script") == described.text.count(f'<script nonce="{nonce}">') == 1
        assert nonce not in (await client.get("/docs")).text
        refused = await client.get("/api/v1/plans", headers={"host": "evil.example"})
        assert directives(refused)["default-src"] == "'none'"


async def test_figures_are_kept_of_known_methods_alone(client: httpx.AsyncClient) -> None:
    """However many words are sent as methods, they are one figure."""
    for number in range(20):
        await client.request(f"ODD{number}", f"/nowhere/{number}")
    text = (await client.get("/metrics")).text
    assert "ODD" not in text
    assert "/nowhere" not in text
    assert 'method="other"' in text


async def test_links_beyond_this_machine_are_refused(client: httpx.AsyncClient) -> None:
    """Over HTTP an address that is not allowed is a 422 that names the setting, and nothing is opened."""
    for url in ("udpin:0.0.0.0:14550", "tcp:192.0.2.1:80", "serial:/dev/mem:57600", "replay:/etc/passwd"):
        answer = await client.post("/api/v1/vehicles", json={"name": "uav", "url": url})
        check_problem(answer, 422, "link-not-allowed")
    forward = [{"url": "udpout:192.0.2.1:14550"}]
    body = {"name": "uav", "url": "udpin:127.0.0.1:0", "timeout_s": 0.1, "forward": forward}
    check_problem(await client.post("/api/v1/vehicles", json=body), 422, "link-not-allowed")
    assert (await client.get("/api/v1/vehicles")).json()["vehicles"] == []


@pytest.mark.parametrize(
    "wrong", [{"link_kinds": "udpin,pigeon"}, {"link_hosts": "10.0.0.1/8"}, {"link_hosts": "http://x"}]
)
def test_settings_that_say_nothing_sensible_are_refused(wrong: dict[str, str]) -> None:
    """A kind there is not, a network with bits set beyond its length, a URL."""
    with pytest.raises(ValueError, match="link_"):
        Settings(**wrong)  # type: ignore[arg-type]


def test_files_are_for_the_service_s_user_alone(tmp_path: Path) -> None:
    """Database, what lies beside it, recordings: whatever the umask of the shell, nobody else reads them."""
    program = (
        "import asyncio, os, sys; os.umask(0); from pathlib import Path\n"
        "from app.services.store.database import Database\n"
        "async def go():\n"
        "    database = Database(Path(sys.argv[1])); await database.open()\n"
        "    async with database.reading() as session: await session.connection()\n"
        "    print(*(f'{p.name} {p.stat().st_mode & 0o777:o}' for p in Path(sys.argv[1]).parent.iterdir()))\n"
        "    await database.close()\n"
        "asyncio.run(go())"
    )
    command = [sys.executable, "-c", program, str(tmp_path / "plans.db")]
    told = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout.split()
    assert {"plans.db", "plans.db-wal", "plans.db-shm", "plans.db.lock"} <= set(told[::2])
    assert set(told[1::2]) == {"600"}
    writer = TlogWriter(tmp_path / "uav")
    writer.write(frames(1)[0])
    writer.close()
    (path,) = (tmp_path / "uav").iterdir()
    assert stat.S_IMODE(path.stat().st_mode) & 0o177 == 0
