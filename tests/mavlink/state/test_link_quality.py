"""The share of a vehicle's frames that arrive, from the numbers they carry."""

from __future__ import annotations

import random

import pytest

from mavlink.state.link_quality import LinkQuality
from mavlink.wire.codec import Codec
from mavlink.wire.messages import Message


@pytest.mark.parametrize("kept", [1.0, 0.8, 0.5])
def test_the_share_that_arrives_is_told(kept: float) -> None:
    """Frames dropped at random, each in a real frame of the codec: the share of the last ten seconds."""
    sender, listener, quality = Codec(1, 1), Codec(255), LinkQuality()
    dice = random.Random(3)
    # Long before, all was lost; that no longer counts.
    moments_s = [number * 0.02 for number in range(2000)]
    arrived = []
    for now_s in moments_s:
        frame = sender.pack(Message("HEARTBEAT", {"autopilot": 3}))
        if now_s < 20.0 or dice.random() >= kept:
            continue
        (message,) = listener.feed(frame)
        quality.heard(message.sequence, now_s)
        arrived.append(now_s)
    share = quality.share(moments_s[-1])
    last = [now_s for now_s in arrived if now_s >= moments_s[-1] - 10.0]
    assert share == pytest.approx(len(last) / 500, abs=0.02)


def test_a_frame_overtaken_is_not_lost() -> None:
    """Neighbours exchanged on the way are all there; one that comes twice makes nothing better."""
    quality = LinkQuality()
    for number in range(0, 40, 2):
        for sequence in (number + 1, number):
            quality.heard(sequence, number * 0.1)
    assert quality.share(4.0) == 1.0
    quality.heard(37, 4.0)
    assert quality.share(4.0) == 1.0


def test_what_cannot_be_told_is_not_told() -> None:
    """Nothing heard, too little heard: unknown. All silent for ten seconds: nothing arrives."""
    quality = LinkQuality()
    assert quality.share(0.0) is None
    for number in range(9):
        quality.heard(number, 0.0)
    assert quality.share(0.0) is None
    quality.heard(9, 0.0)
    assert quality.share(0.0) == 1.0
    assert quality.share(11.0) == 0.0


def test_a_vehicle_that_counts_anew_has_lost_nothing() -> None:
    """After a loss the first number is whatever it is."""
    quality = LinkQuality()
    for number in range(20):
        quality.heard(number, number * 0.1)
    quality.forget()
    for number in range(100, 120):
        quality.heard(number % 256, 3.0)
    assert quality.share(3.0) == 1.0
