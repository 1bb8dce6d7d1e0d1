// SPDX-License-Identifier: Apache-2.0
// A gamepad: the left stick walks, the right one looks around, triggers go down and up, and the first two buttons run the script's
// actions that name a controller's button.

import type { Commands } from "../commands/commands.ts";
import type { Navigation } from "../navigate/navigation.ts";

/** Dead zone: a stick at rest has small values. */
const deadZone = 0.15;
/** Speed of looking around at full stick, as px of a mouse's drag per second. */
const lookPace = 500;

export class GamepadInput {
  private readonly navigation_: Navigation;
  private readonly commands_: Pick<Commands, "script">;
  private walking_ = false;
  private readonly down_ = [false, false];

  constructor(navigation: Navigation, commands: Pick<Commands, "script">) {
    this.navigation_ = navigation;
    this.commands_ = commands;
  }

  /** Returns whether the camera moves. */
  aim(seconds: number, pad: Gamepad | null = navigator.getGamepads().find((each) => each !== null) ?? null): boolean {
    if (pad === null) return false;
    const [x, y, lookX, lookY] = [0, 1, 2, 3].map((axis) => bent(pad.axes[axis] ?? 0));
    const up = bent((pad.buttons[7]?.value ?? 0) - (pad.buttons[6]?.value ?? 0));
    const walks = x !== 0 || y !== 0 || up !== 0;
    // Keys walk too: the stick ends only a motion that it has begun.
    if (walks || this.walking_) this.navigation_.walk.set(x, up, -y);
    this.walking_ = walks;
    if (lookX !== 0 || lookY !== 0) this.navigation_.look(-lookX * lookPace * seconds, -lookY * lookPace * seconds);
    (["a", "b"] as const).forEach((name, button) => {
      const pressed = pad.buttons[button]?.pressed === true;
      if (pressed && !this.down_[button]) this.commands_.script.find((command) => command.button === name)?.run();
      this.down_[button] = pressed;
    });
    return walks || lookX !== 0 || lookY !== 0;
  }
}

/** Zero in the dead zone, and finer near it than at the edge. */
function bent(value: number): number {
  const beyond = Math.max(0, Math.abs(value) - deadZone) / (1 - deadZone);
  return Math.sign(value) * beyond * beyond;
}
