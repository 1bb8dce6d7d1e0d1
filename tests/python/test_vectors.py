# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import pickle
from collections.abc import Sequence

import numpy as np
import pytest

import iota
from iota import Vec3


@pytest.mark.parametrize("value", [(1, 2), [1, 2, 0], (1.0, 2.0, 0.0), np.array([1, 2, 0]), Vec3(1, 2), range(1, 3)])
def test_a_position_is_any_two_or_three_numbers(system: iota.System, value: Sequence[float]) -> None:
    particle = system.body().particle(position=value)
    assert particle.position == (1, 2, 0)


@pytest.mark.parametrize("value", ["12", (1,), (1, 2, 3, 4), 5, ("a", "b"), {"x": 1}, b"ab"])
def test_anything_else_is_a_type_error_that_names_it(system: iota.System, value: object) -> None:
    with pytest.raises(TypeError, match="position must be 2 or 3 numbers, not"):
        system.body().particle(position=value)


def test_vectors_calculate_with_tuples_and_arrays() -> None:
    v = Vec3(1, 2, 3)
    assert v + (1, 1) == (2, 3, 3)
    assert (1, 1, 1) - v == (0, -1, -2)
    assert 2 * v == v * 2 == (2, 4, 6)
    assert -v / 2 == (-0.5, -1, -1.5)
    assert abs(Vec3(3, 4, 0)) == Vec3(3, 4).length == 5
    assert v.dot((1, 0, 0)) == 1
    assert Vec3(1, 0, 0).cross((0, 1, 0)) == (0, 0, 1)
    assert Vec3(0, 0, 2).unit() == (0, 0, 1)
    assert Vec3().unit() == (0, 0, 0)
    x, y, z = v
    assert [x, y, z] == list(v) == [v.x, v[1], v[-1]]


def test_vectors_turn_into_arrays_and_broadcast_with_them() -> None:
    v = Vec3(1, 2, 3)
    assert np.asarray(v).dtype == np.float64
    np.testing.assert_array_equal(np.zeros((2, 3)) + v, [[1, 2, 3], [1, 2, 3]])
    np.testing.assert_array_equal(v + np.zeros((2, 3)), [[1, 2, 3], [1, 2, 3]])


def test_vectors_cannot_be_changed_but_assigning_works(system: iota.System) -> None:
    particle = system.body().particle()
    with pytest.raises(TypeError):
        particle.position[1] = 3
    with pytest.raises(AttributeError):
        particle.position.y = 3
    particle.position += (0, 3, 0)
    assert particle.position == (0, 3, 0)


def test_vectors_are_sequences_and_hash_and_pickle_by_value() -> None:
    v = Vec3(1, 2, 3)
    assert isinstance(v, Sequence)
    assert hash(v) == hash(Vec3(1, 2, 3))
    assert pickle.loads(pickle.dumps(v)) == v
    assert eval(repr(v)) == v
    assert v != "abc" and v != (1, 2)
    with pytest.raises(ZeroDivisionError):
        v / 0
    with pytest.raises(TypeError):
        v + "abc"
    with pytest.raises(IndexError):
        v[3]
