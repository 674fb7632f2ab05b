"""Signing over HTTP and on the command line: keys come from file or environment, and are nowhere else."""

from __future__ import annotations

import asyncio
import stat
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest
from typer.testing import CliRunner

from app.cli.root import cli
from app.main import create_app
from app.services.errors import RefusedError
from app.services.vehicles.keys import KeptTimes, KeyRing
from app.settings import Settings, unknown_variables
from mavlink.links.link import open_link
from mavlink.sim.settings import SimSettings
from mavlink.wire.signing import SigningKey, parse_key
from tests.app.conftest import impatient_house, serving, stored
from tests.app.test_problems import check_problem
from tests.app.test_restart import VEHICLES, flying, free_port, until

KEY, OTHER = bytes(range(32)), bytes(range(1, 33))


@pytest.fixture
def keys(tmp_path: Path) -> Path:
    """A file with the key of the vehicle ``uav``."""
    file = tmp_path / "keys"
    file.write_text(f"# ours\nuav = {KEY.hex()}\n")
    file.chmod(0o600)
    return file


@asynccontextmanager
async def aircraft(port: int, key: bytes = b"") -> AsyncIterator[None]:
    """A simulated aircraft with a key, or none yet."""
    link = await open_link(f"tcp:127.0.0.1:{port}")
    try:
        async with flying(link, SimSettings(signing_key=key)):
            yield
    finally:
        await link.close()


async def test_a_signing_vehicle_is_flown_and_its_key_is_nowhere(
    settings: Settings, plan_file: Path, keys: Path, tmp_path: Path
) -> None:
    """Verified, uploaded to, its key taken away and handed over again; no file of the service holds it."""
    port = free_port()
    signed = settings.model_copy(update={"signing_keys": keys})
    async with serving(create_app(signed, impatient_house)) as client:
        url = f"tcpin:127.0.0.1:{port}"
        place = (await client.post(VEHICLES, json={"name": "uav", "url": url, "timeout_s": 0.1})).headers[
            "location"
        ]
        async with aircraft(port, KEY):
            assert (await until(client, lambda body: body["connected"]))["signing"] == "verified"
            plan_id = await stored(client, plan_file)
            report = await client.post(place + "/mission", json={"plan_id": plan_id})
            assert report.json()["verified"], report.text
            for action, then in (("remove", None), ("set_up", "verified"), ("use", "verified")):
                changed = await client.post(place + "/signing", json={"action": action})
                assert changed.status_code == 200, changed.text
                await until(client, lambda body, then=then: body["signing"] == then and body["connected"])
            listed = (await client.get("/api/v1/audit")).json()
            assert sum(entry["kind"] == "signing" for entry in listed["entries"]) == 3
            answers = str(listed) + (await client.get(VEHICLES)).text
    folder = signed.database.parent
    kept = folder / "signing"
    assert [stat.S_IMODE(path.stat().st_mode) for path in (kept, *kept.iterdir())] == [0o700, 0o600]
    written = [path for path in tmp_path.rglob("*") if path.is_file() and path != keys]
    assert any(path.suffix == ".tlog" for path in written)
    for content in (answers.encode(), *(path.read_bytes() for path in written)):
        assert KEY not in content
        assert KEY.hex().encode() not in content


async def test_what_stands_against_a_key_is_said(
    settings: Settings, keys: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A vehicle with another key or none, no key given, and a file that others may read."""
    port = free_port()
    signed = settings.model_copy(update={"signing_keys": keys})
    async with serving(create_app(signed, impatient_house)) as client:
        url = f"tcpin:127.0.0.1:{port}"
        place = (await client.post(VEHICLES, json={"name": "uav", "url": url, "timeout_s": 0.1})).headers[
            "location"
        ]
        for key, words in ((OTHER, "another key"), (b"", "does not sign")):
            async with aircraft(port, key):
                said = {"another key": "wrong_key", "does not sign": "unsigned"}[words]
                await until(client, lambda body, said=said: body["signing"] == said)
                refused = await client.post(place + "/commands", json={"command": "arm"})
                check_problem(refused, 409)
                assert words in refused.json()["detail"]
        other = await client.post(VEHICLES, json={"name": "keyless", "url": "sim:"})
        place = other.headers["location"]
        refused = await client.post(place + "/signing", json={"action": "set_up"})
        check_problem(refused, 409)
        assert "no signing key of keyless is given" in refused.json()["detail"]
        check_problem(await client.post(place + "/signing", json={"action": "sign"}), 422)
        keys.chmod(0o640)
        refused = await client.post(
            VEHICLES, json={"name": "third", "url": f"udpin:127.0.0.1:{free_port()}", "timeout_s": 0.1}
        )
        check_problem(refused, 422, "signing-key")
        assert "chmod 600" in refused.text


def test_where_keys_are_found(keys: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By the name in the file, then the environment, then for all; the variables are no unknown settings."""
    environment = {"SWATHPLAN_SIGNING_KEY_UAV_2": OTHER.hex(), "SWATHPLAN_SIGNING_KEY": "passphrase:x"}
    ring = KeyRing(keys, None, environment)
    found = {name: ring.key_of(name) for name in ("uav", "uav 2", "uav-3")}
    assert found["uav"] == SigningKey(KEY)
    assert found["uav 2"] == SigningKey(OTHER)
    assert found["uav-3"] == parse_key("passphrase:x")
    assert KeyRing(None, None, {}).signing_of("uav", "1") is None
    for name, text in environment.items():
        monkeypatch.setenv(name, text)
    monkeypatch.setenv("SWATHPLAN_SIGNING_KEYZ", "x")
    assert unknown_variables() == ("SWATHPLAN_SIGNING_KEYZ",)
    for text in ("uav = hunter2", "hunter2", "uav = " + "0" * 64):
        keys.write_text(text)
        with pytest.raises(RefusedError) as caught:
            ring.key_of("uav")
        assert "hunter2" not in str(caught.value)
    with pytest.raises(RefusedError, match="No such file"):
        KeyRing(tmp_path / "none", None, {}).key_of("uav")


def test_times_are_kept(tmp_path: Path) -> None:
    """As they were; nonsense is said and begun anew, and a folder that is none stops nothing."""
    kept = KeptTimes(tmp_path / "signing" / "1.json")
    assert kept.load() == (0, {})
    kept.save(77, {(1, 1, 0): 5})
    assert KeptTimes(tmp_path / "signing" / "1.json").load() == (77, {(1, 1, 0): 5})
    for text in ("", "[]", '{"timestamp": 1}', '{"timestamp": 1, "streams": {"x": 1}}'):
        (tmp_path / "signing" / "1.json").write_text(text)
        assert kept.load() == (0, {})
    (tmp_path / "file").touch()
    KeptTimes(tmp_path / "file" / "1.json").save(1, {})


async def test_a_key_is_made_and_handed_over_from_the_command_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A new file that only its owner reads; the vehicle takes it, and the next one signed with it.

    Without a key of its own a download says why not.
    """
    file, port = tmp_path / "keys.txt", free_port()
    runner = CliRunner()

    async def run(*arguments: str) -> tuple[int, str]:
        result = await asyncio.to_thread(runner.invoke, cli, list(arguments))
        return result.exit_code, result.output + str(result.exception or "")

    code, _ = await run("signing", "new", "-o", str(file))
    assert code == 0
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    secret = file.read_text().split("=")[1].strip()
    assert (await run("signing", "new", "-o", str(file)))[0] != 0
    assert (await run("signing", "set-up", "--to", "tcp:127.0.0.1:1"))[0] != 0
    server = await open_link(f"tcpin:127.0.0.1:{port}")
    url = f"tcp:127.0.0.1:{port}"
    async with flying(server, SimSettings()):
        monkeypatch.setenv("SWATHPLAN_SIGNING_KEYS", str(file))
        said = await run("signing", "set-up", "--to", url)
        assert said[0] == 0, said
        held = await run("download", "--from", url, "-o", str(tmp_path / "held.plan"))
        assert held[0] == 0, held
        new = tmp_path / "new.txt"
        assert (await run("signing", "new", "-o", str(new)))[0] == 0
        monkeypatch.setenv("SWATHPLAN_SIGNING_KEYS", str(new))
        wrong = await run("signing", "set-up", "--to", url, "--in-use", str(new), "--timeout-s", "2")
        assert wrong[0] != 0, "that is not the key in use"
        replaced = await run("signing", "set-up", "--to", url, "--in-use", str(file))
        assert replaced[0] == 0, replaced
        held = await run("download", "--from", url, "-o", str(tmp_path / "held.plan"))
        assert held[0] == 0, held
        assert new.read_text().split("=")[1].strip() not in wrong[1] + replaced[1] + held[1]
        for action, named, words in (
            ("remove", str(file), "goes with set-up"),
            ("set-up", str(tmp_path / "none"), "cannot be read"),
        ):
            refused = await run("signing", action, "--to", url, "--in-use", named)
            assert refused[0] != 0
            assert words in refused[1]
        monkeypatch.delenv("SWATHPLAN_SIGNING_KEYS")
        monkeypatch.setenv("SWATHPLAN_SIGNING_KEY", OTHER.hex())
        failed = await run("download", "--from", url, "-o", str(tmp_path / "no.plan"), "--timeout-s", "3")
        assert failed[0] != 0
        assert "another key" in failed[1]
        assert secret not in said[1] + held[1] + failed[1]
    await server.close()
