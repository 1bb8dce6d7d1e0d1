// SPDX-License-Identifier: Apache-2.0
// What a user can ask for in a headset only: getting about, and leaving.

import type { Entry } from "../commands/command.ts";

const signs = {
  left: "M9 5L4 10l5 5M4 10h10a5.5 5.5 0 0 1 5.5 5.5V19",
  right: "M15 5l5 5-5 5M20 10H10a5.5 5.5 0 0 0-5.5 5.5V19",
};

export interface HeadsetActs {
  /** A snap turn: 1 to the left, -1 to the right. */
  turn(direction: 1 | -1): void;
  /** Aims a teleport with the hand that pressed. */
  aimTeleport(): void;
  teleportArmed(): boolean;
  leave(): void;
}

export function headsetCommands(acts: HeadsetActs): Entry[] {
  return [
    { name: "turn left", places: ["panel foot"], title: () => "Turn left", sign: () => signs.left, run: () => acts.turn(1) },
    { name: "turn right", places: ["panel foot"], title: () => "Turn right", sign: () => signs.right, run: () => acts.turn(-1) },
    { name: "go", places: ["panel foot"], title: () => "Go to ...", active: () => acts.teleportArmed(), run: () => acts.aimTeleport() },
    { name: "leave", places: ["panel foot"], title: () => "Leave VR", run: () => acts.leave() },
  ];
}
