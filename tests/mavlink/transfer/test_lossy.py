"""Transfers over a bad radio: whatever is lost, doubled or overtaken, the outcome said is true."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mavlink.transfer.download import DownloadMachine
from mavlink.transfer.outcome import Accepted, Refused, Unknown
from mavlink.transfer.upload import UploadMachine
from mavlink.wire.items import MissionResult, MissionType
from tests.mavlink.transfer.air import Air, Weather
from tests.mavlink.transfer.vehicle import StubVehicle, waypoints

manners = st.sampled_from(["ardupilot", "px4"])
weathers = st.builds(
    Weather,
    loss=st.sampled_from([0.0, 0.05, 0.3, 0.7]),
    duplication=st.sampled_from([0.0, 0.2]),
    reordering=st.sampled_from([0.0, 0.2]),
    seed=st.integers(0, 2**32),
)


@settings(max_examples=300, deadline=None)
@given(manners, weathers, st.integers(0, 12), st.integers(0, 12))
def test_an_upload_never_claims_what_is_not_so(
    manner: str, weather: Weather, count: int, before: int
) -> None:
    """Accepted: the vehicle stored exactly this list. Refused: it said so. Unknown: only in bad weather."""
    vehicle = StubVehicle(manner)
    vehicle.held[0] = waypoints(before)
    machine = UploadMachine(waypoints(count), MissionType.MISSION, 1, 1)
    Air(machine, vehicle, weather).run()
    match machine.outcome:
        case Accepted():
            assert waypoints(count) in vehicle.stored
        case Refused(result=result):
            assert result in vehicle.said
        case Unknown():
            assert weather != Weather(seed=weather.seed)
        case outcome:
            pytest.fail(f"no outcome: {outcome}")


@settings(max_examples=200, deadline=None)
@given(
    manners,
    weathers,
    st.integers(0, 5),
    st.sampled_from([result for result in MissionResult if result not in (0, 1, 13)]),
)
def test_a_refused_item_is_never_accepted(
    manner: str, weather: Weather, refused: int, result: MissionResult
) -> None:
    """A vehicle that refuses an item ends the upload as refused with its code; in bad weather, or unknown."""
    vehicle = StubVehicle(manner, {refused: result})
    machine = UploadMachine(waypoints(6), MissionType.MISSION, 1, 1)
    Air(machine, vehicle, weather).run()
    assert machine.outcome != Accepted()
    if weather == Weather(seed=weather.seed):
        assert machine.outcome == Refused(result, refused)
    elif isinstance(machine.outcome, Refused):
        assert machine.outcome.result in vehicle.said


@settings(max_examples=300, deadline=None)
@given(manners, weathers, st.integers(0, 12))
def test_a_download_is_exact_or_not_at_all(manner: str, weather: Weather, count: int) -> None:
    """An accepted download equals what the vehicle holds, item by item; in good weather it is accepted."""
    vehicle = StubVehicle(manner)
    vehicle.held[0] = waypoints(count)
    machine = DownloadMachine(MissionType.MISSION, 1, 1)
    Air(machine, vehicle, weather).run()
    if machine.outcome == Accepted():
        assert machine.items == waypoints(count)
    else:
        assert isinstance(machine.outcome, Unknown)
        assert weather.loss > 0.0


@pytest.mark.parametrize("manner", ["ardupilot", "px4"])
@pytest.mark.parametrize("seed", range(5))
def test_a_tenth_lost_does_not_stop_a_transfer(manner: str, seed: int) -> None:
    """With 10 % loss and duplicates two hundred items still go up and come back."""
    vehicle = StubVehicle(manner)
    weather = Weather(loss=0.1, duplication=0.05, seed=seed)
    upload = UploadMachine(waypoints(200), MissionType.MISSION, 1, 1)
    Air(upload, vehicle, weather).run()
    assert vehicle.stored[-1] == waypoints(200)
    download = DownloadMachine(MissionType.MISSION, 1, 1)
    Air(download, vehicle, weather).run()
    assert download.items == waypoints(200)


@pytest.mark.parametrize("manner", ["ardupilot", "px4"])
def test_a_stored_list_with_a_lost_last_word_is_unknown(manner: str) -> None:
    """The vehicle holds everything, yet without its word that is not claimed."""
    vehicle = StubVehicle(manner)
    vehicle.lose_final = True
    machine = UploadMachine(waypoints(4), MissionType.MISSION, 1, 1)
    Air(machine, vehicle).run()
    assert vehicle.held[0] == waypoints(4)
    assert machine.outcome == Unknown("lost-acknowledgement", 3)
