# SPDX-License-Identifier: Apache-2.0
"""The script that repeats the review of the physics runs, and its figures that do not depend on the machine hold."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

FILE = Path(__file__).parents[2] / "bench" / "review_physics.py"


@pytest.fixture(scope="module")
def review() -> ModuleType:
    spec = importlib.util.spec_from_file_location("review_physics", FILE)
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    sys.modules["review_physics"] = module
    spec.loader.exec_module(module)
    return module


FAST = [
    "rolling_ball",
    "table_on_ground",
    "rolling_cylinder",
    "pushed_box",
    "gliding_table",
    "fall_on_ground",
    "magnetic_force",
    "applied_torque",
    "fast_shaft",
    "motor_at_its_limit",
    "says_and_turns",
    "needle_link",
    "sleeping_bond",
    "far_hinge",
    "taut_net_makes_no_energy",
    "spin_of_a_point",
    "ignored_arguments",
]


@pytest.mark.parametrize("name", FAST)
def test_what_the_review_found_is_as_it_should_be(review: ModuleType, name: str) -> None:
    missed = [(what, now, wanted) for what, _, now, wanted in getattr(review, name)() if not now <= wanted]
    assert missed == []


@pytest.mark.parametrize("name", ["spherical pendulum", "elastic pendulum", "figure of eight, bonds", "Dzhanibekov"])
def test_the_default_mode_is_of_second_order_in_the_scenes_of_the_review(review: ModuleType, name: str) -> None:
    (scene,) = [scene for title, scene, *_ in review.ORDERS if title.startswith(name)]
    truth = scene.truth()
    errors = [float(np.abs(scene.play("energy_keeping", hz) - truth).max()) for hz in (120, 240)]
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.05)
