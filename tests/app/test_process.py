"""The service as a process: live events, killed workers, crashes, orderly ends."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
import pytest

ROOT = Path(__file__).resolve().parents[2]
PLANS = "/api/v1/plans"


class Service:
    """A running service process and a client of it."""

    def __init__(self, process: subprocess.Popen[str], client: httpx.Client) -> None:
        self.process = process
        self.client = client

    def post(self, fake: str, wait_s: float = 0) -> dict[str, Any]:
        """Post a scenario for the stand-in."""
        body = {"features": [{}], "name": fake, "fake": fake}
        answer: dict[str, Any] = self.client.post(PLANS, json=body, params={"wait": wait_s}).json()
        return answer

    def until(self, plan_id: str, *states: str) -> dict[str, Any]:
        """A plan's record once it is in one of some states."""
        end_s = time.monotonic() + 60
        while time.monotonic() < end_s:
            record: dict[str, Any] = self.client.get(f"{PLANS}/{plan_id}").json()
            if record["state"] in states:
                return record
            time.sleep(0.02)
        raise AssertionError(f"{plan_id} is {record}")

    def children(self, word: bytes) -> list[int]:
        """Process ids of the child processes with a word in their command line."""
        children = []
        for task in Path(f"/proc/{self.process.pid}/task").iterdir():
            children += [int(pid) for pid in (task / "children").read_text().split()]
        return [pid for pid in children if word in Path(f"/proc/{pid}/cmdline").read_bytes()]

    def workers(self) -> list[int]:
        """Process ids of the planning processes."""
        return self.children(b"spawn_main")


@contextmanager
def service(database: Path, *words: str) -> Iterator[Service]:
    """A service process on a database, ended by SIGTERM."""
    command = [sys.executable, "-m", "tests.app.fake_server", str(database), *words]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        address = process.stdout.readline().strip()
        try:
            with httpx.Client(base_url=address, timeout=180) as client:
                yield Service(process, client)
        finally:
            if process.poll() is None:
                process.terminate()
            process.wait(60)


def events(lines: Iterator[str]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Server-sent events as they come."""
    name = ""
    for line in lines:
        if line.startswith("event: "):
            name = line[7:]
        elif line.startswith("data: "):
            yield name, json.loads(line[6:])


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="looks for workers in /proc")
def test_killed_workers_fail_their_plan_at_most(tmp_path: Path) -> None:
    """SIGKILL in mid-plan: events tell progress, then failed; the next is made, also after one while idle."""
    with service(tmp_path / "plans.db") as running:
        plan = running.post("slow")
        with running.client.stream("GET", f"{PLANS}/{plan['id']}/events") as stream:
            for name, record in events(stream.iter_lines()):
                if name == "progress" and record["progress"] > 0.25:
                    for pid in running.workers():
                        os.kill(pid, signal.SIGKILL)
        assert name == "failed"
        assert record["error"]["type"] == "worker-died"
        assert "signal 9" in record["error"]["detail"]
        assert running.post("done", wait_s=20)["state"] == "done"
        killed = set(running.workers())
        for pid in killed:
            os.kill(pid, signal.SIGKILL)
        # The pool breaks, or has others in their place before anybody looks.
        while (ready := running.client.get("/health/ready")).status_code == 200:
            now = set(running.workers())
            if now and not now & killed:
                break
            time.sleep(0.02)
        if ready.status_code != 200:
            assert ready.json()["checks"] == {"database": True, "workers": False}
        assert running.post("done", wait_s=20)["state"] == "done"


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="looks for processes in /proc")
def test_crash_fails_the_running_and_keeps_the_rest(tmp_path: Path) -> None:
    """After SIGKILL to the service: done plans stay, the running one failed, the waiting one is made.

    The simulated aircraft does not outlive the service.
    """
    with service(tmp_path / "plans.db") as first:
        done = first.post("done", wait_s=20)
        running = first.post("slow")
        waiting = first.post("done")
        first.until(running["id"], "running")
        first.client.post("/api/v1/vehicles", json={"name": "uav", "url": "sim:"}).raise_for_status()
        (simulator,) = first.children(b"simulator")
        first.process.kill()
        first.process.wait()
        end_s = time.monotonic() + 60
        while Path(f"/proc/{simulator}/cmdline").exists() and time.monotonic() < end_s:
            time.sleep(0.05)
        assert not Path(f"/proc/{simulator}/cmdline").exists()
    with service(tmp_path / "plans.db") as second:
        assert second.client.get(f"{PLANS}/{done['id']}").json() == done
        assert second.until(running["id"], "failed")["error"]["type"] == "service-restarted"
        assert second.until(waiting["id"], "done")["state"] == "done"


def test_sigterm_ends_open_streams(tmp_path: Path) -> None:
    """An orderly end closes event streams and exits cleanly."""
    with service(tmp_path / "plans.db") as running:
        plan = running.post("slow")
        running.until(plan["id"], "running")
        with running.client.stream("GET", f"{PLANS}/{plan['id']}/events") as stream:
            for name, _ in events(stream.iter_lines()):
                assert name == "progress"
                if running.process.poll() is None:
                    running.process.terminate()
        assert running.process.wait(60) in (0, -signal.SIGTERM)


@pytest.mark.parametrize("words", [("sample",), ("sample", "apart")])
def test_who_comes_first_finds_the_sample(tmp_path: Path, words: tuple[str, ...]) -> None:
    """Once the address is told, the scenario that the service plans by itself is among its plans."""
    with service(tmp_path / "plans.db", *words) as running:
        (plan,) = running.client.get(PLANS).json()["plans"]
        assert plan["name"] == "sample"
