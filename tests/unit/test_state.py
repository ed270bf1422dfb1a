"""A state written down is the same state again."""

from dataclasses import fields

import numpy as np

from rubnoise.contact.off_centre import OFF_CENTRE_LENS
from rubnoise.simulation.state import LiveRows, State
from tests.models import model, run_to_end


def assert_same(one: State, two: State) -> None:
    for f in fields(State):
        if f.name != "live":
            assert getattr(one, f.name) == getattr(two, f.name)
    for f in fields(LiveRows):
        a, b = getattr(one.live, f.name), getattr(two.live, f.name)
        if a is None or b is None:
            assert a is b
            continue
        assert a.dtype == b.dtype
        assert a.tobytes() == b.tobytes()


def test_a_state_survives_its_bytes():
    _, state = run_to_end(model())
    assert len(state.live) > 0
    assert_same(State.unpack(state.pack()), state)


def test_offsets_survive_too_and_a_state_from_before_them_has_none():
    _, state = run_to_end(model(pulse=OFF_CENTRE_LENS))
    assert state.live.offset is not None
    assert_same(State.unpack(state.pack()), state)
    _, centred = run_to_end(model())
    assert b"offsets" in state.pack()
    assert b"offsets" not in centred.pack()


def test_a_state_without_rows_survives_its_bytes():
    state = State(
        block=3,
        begin=1 / 3,
        next_birth=1e300,
        junctions=0,
        ticks=7,
        events=9,
        live=LiveRows.none(),
        slider_rows=5,
        displacement=-0.0,
        velocity=5e-324,
    )
    again = State.unpack(state.pack())
    assert_same(again, state)
    assert np.signbit(again.displacement)
