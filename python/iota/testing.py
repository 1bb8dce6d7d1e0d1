# SPDX-License-Identifier: Apache-2.0
"""Tests of a script's world as a visitor in a headset meets it, without a headset."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Literal, TypeVar

from iota._core import Body, Particle, Vec3
from iota.film.browser import open_browser
from iota.film.files import Failed
from iota.saving import replacing
from iota.world import World

Hand = Literal["left", "right"]
Button = Literal["trigger", "squeeze", "a", "b", "x", "y"]
Place = Body | Particle | Sequence[float] | Vec3
Result = TypeVar("Result")

SIZE = {"width": 480, "height": 270}  # px, as a software renderer is slow
PATIENCE = 60.0  # s

# The rotation that takes -z to a direction: half-way quaternion of (0, 0, -1) and it.
PLACE_HAND = """([side, to, target]) => {
  const { device } = iotaXR;
  const parts = [device.controllers[side], device.hands[side]].filter(Boolean);
  const { position } = parts[0];
  const at = to === null ? [position.x, position.y, position.z] : iotaXR.toSpace(to);
  for (const part of parts) part.position.set(...at);
  if (target === null) return;
  const way = iotaXR.toSpace(target).map((value, axis) => value - at[axis]);
  const [x, y, z] = way.map((value) => value / Math.hypot(...way));
  const half = Math.hypot(y, -x, 1 - z);
  for (const part of parts) part.quaternion.set(y / half, -x / half, 0, (1 - z) / half);
}"""
LOOK = """(target) => {
  const { device } = iotaXR;
  const { position } = device;
  const [x, y, z] = iotaXR.toSpace(target).map((value, axis) => value - [position.x, position.y, position.z][axis]);
  const [yaw, pitch] = [Math.atan2(-x, -z), Math.atan2(y, Math.hypot(x, z))];
  const [cy, sy, cp, sp] = [Math.cos(yaw / 2), Math.sin(yaw / 2), Math.cos(pitch / 2), Math.sin(pitch / 2)];
  device.quaternion.set(cy * sp, sy * cp, -sy * sp, cy * cp);
}"""
FRAMES = "async (count) => { while (count-- > 0) await new Promise((done) => requestAnimationFrame(done)); }"


class Headset:
    """A visitor with an emulated headset (Meta Quest 3), in a browser without a window, in a world that runs: see
    `World.start`. Places are of the world, m; a body or a particle stands for its place at the moment. Needs Chromium
    and the package playwright; raises Failed with what to do where they are missing.

        world.start(port=0)
        with iota.testing.Headset(world) as visitor:
            visitor.point("right", at=ball)
            visitor.press("right", "trigger")
            visitor.wait_for(lambda: world.users.held() == ball)
            visitor.move("right", (0, 1.6, 0.3))
            visitor.release("right", "trigger")
    """

    def __init__(self, world: World) -> None:
        self._world = world
        self._open = ExitStack()

    def __enter__(self) -> Headset:
        if self._world.pages.url is None:
            raise Failed("the world is on no page. Try: world.start(port=0)")
        with ExitStack() as opened:
            browser = opened.enter_context(open_browser("headsets for tests"))
            self._page = browser.new_page(viewport=SIZE)
            self._page.goto(f"{self._world.pages.url}&emulate=quest3")
            self._until("globalThis.iotaXR !== undefined && iota.connected")
            self._page.evaluate("iotaXR.enter()")
            self._until("iotaXR.presenting && iotaXR.inputs().length === 2")
            self._open = opened.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        self._open.close()

    @property
    def head(self) -> Vec3:
        """Between the eyes."""
        return Vec3(*self._page.evaluate("iotaXR.head()"))

    def look(self, at: Place) -> None:
        """Turns the head towards a place."""
        self._page.evaluate(LOOK, self._place(at))
        self._let_pass(2)

    def point(self, hand: Hand, at: Place) -> None:
        """Turns a hand so that its ray goes through a place."""
        self._page.evaluate(PLACE_HAND, [hand, None, self._place(at)])
        self._let_pass(2)

    def move(self, hand: Hand, to: Place) -> None:
        """Puts a hand at a place; its direction stays."""
        self._page.evaluate(PLACE_HAND, [hand, self._place(to), None])
        self._let_pass(2)

    def press(self, hand: Hand, button: Button = "trigger") -> None:
        """Presses a button of a controller."""
        self._set_button(hand, button, 1)

    def release(self, hand: Hand, button: Button = "trigger") -> None:
        self._set_button(hand, button, 0)

    def pinch(self, hand: Hand, closed: bool = True) -> None:
        """Brings thumb and index finger of a bare hand together, or apart."""
        self._page.evaluate("([side, value]) => iotaXR.device.hands[side].updatePinchValue(value)", [hand, int(closed)])
        self._let_pass(2)

    def stick(self, hand: Hand, right: float, down: float) -> None:
        """Pushes a thumbstick, from -1 to 1 each."""
        self._page.evaluate(
            "([side, x, y]) => iotaXR.device.controllers[side].updateAxes('thumbstick', x, y)", [hand, right, down]
        )
        self._let_pass(2)

    def use_hands(self, bare: bool = True) -> None:
        """Lays the controllers aside, or takes them again."""
        mode, wanted = ("hand", "hand") if bare else ("controller", "!hand")
        self._page.evaluate("(mode) => { iotaXR.device.primaryInputMode = mode; }", mode)
        self._until(f"iotaXR.inputs().length === 2 && iotaXR.inputs().every(({{ hand }}) => {wanted})")

    def wait_for(self, condition: Callable[[], Result], seconds: float = PATIENCE) -> Result:
        """Calls a function on the world's thread until its result is true, and returns that. Raises TimeoutError."""
        end = time.monotonic() + seconds
        while not (found := self._world.call(condition)):
            if time.monotonic() > end:
                raise TimeoutError(f"{condition!r} did not become true within {seconds:g} s")
            self._let_pass(1)
        return found

    def picture(self, file: str | Path) -> None:
        """The views of both eyes, side by side, as a PNG file."""
        data = self._page.screenshot()
        with replacing(Path(file)) as fresh:
            fresh.write_bytes(data)

    def _set_button(self, hand: Hand, button: Button, value: int) -> None:
        name = button if button in ("trigger", "squeeze") else f"{button}-button"
        self._page.evaluate(
            "([side, name, value]) => iotaXR.device.controllers[side].updateButtonValue(name, value)",
            [hand, name, value],
        )
        self._let_pass(2)

    def _place(self, place: Place) -> list[float]:
        def now() -> list[float]:
            if isinstance(place, Body):
                return list(place.center_of_mass)
            return list(place.position if isinstance(place, Particle) else Vec3(*place))

        return self._world.call(now)

    def _until(self, condition: str) -> None:
        """Waits for a condition of the page. Raises TimeoutError."""
        end = time.monotonic() + PATIENCE
        while not self._page.evaluate(condition):
            if time.monotonic() > end:
                raise TimeoutError(f"the page was not ready within {PATIENCE:g} s: {condition}")
            time.sleep(0.01)

    def _let_pass(self, frames: int) -> None:
        self._page.evaluate(FRAMES, frames)
