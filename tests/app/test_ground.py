"""A vehicle that asks for the ground's heights gets those of the rasters uploaded."""

from __future__ import annotations

import asyncio

from app.main import create_app
from app.settings import Settings
from mavlink.wire.messages import Message
from tests.app.conftest import fake_house, serving
from tests.app.rasters import ramp
from tests.app.test_restart import free_port
from tests.app.test_strangers import aircraft
from tests.patience import PATIENCE_S

# The ramp of the raster: 100 m + 1 m a column and 2 m a row from 0.05° W, 0.07° N, every 0.002°.
STEP_DEG, WEST_DEG, NORTH_DEG = 0.002, -0.05 + 0.001, 0.07 - 0.001


async def test_a_vehicle_is_served_the_ground_under_it(settings: Settings) -> None:
    """Heights of the raster where it has them, to a metre; nothing is said of ground beside it."""
    port = free_port()
    async with serving(create_app(settings, fake_house)) as client, aircraft(port) as flying:
        sent = await client.post("/api/v1/terrain?filename=a.tif&datum=EGM96", content=ramp())
        assert sent.status_code == 201, sent.text
        await client.post("/api/v1/vehicles", json={"name": "uav", "url": f"udpin:127.0.0.1:{port}"})

        async def ask(lat_deg: float, lon_deg: float) -> None:
            place = {"lat": round(lat_deg * 1e7), "lon": round(lon_deg * 1e7)}
            await flying.say("TERRAIN_REQUEST", **place, grid_spacing=100, mask=0b1)

        def answers() -> list[Message]:
            return [each for each in flying.heard if each.name == "TERRAIN_DATA"]

        await ask(50.0, 8.0)
        async with asyncio.timeout(PATIENCE_S):
            while not answers():
                await ask(0.01, 0.02)
                await asyncio.sleep(0.1)
        for answer in answers():
            assert answer.integer("lat") == 100_000
            data = answer.fields["data"]
            assert isinstance(data, tuple)
            for number, height_m in enumerate(data):
                lat_deg = 0.01 + number // 4 * 100.0 / 111_319.0
                lon_deg = 0.02 + number % 4 * 100.0 / 111_319.0
                column, row = (lon_deg - WEST_DEG) / STEP_DEG, (NORTH_DEG - lat_deg) / STEP_DEG
                assert abs(height_m - (100.0 + column + 2.0 * row)) < 1.0
