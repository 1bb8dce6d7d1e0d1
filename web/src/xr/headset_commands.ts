// SPDX-License-Identifier: Apache-2.0
// Commands for the headset only: moving, and leaving.

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
  /** Degrees of a turn by the stick; 0: smooth. */
  turnBy(): number;
  nextTurn(): void;
  seated(): boolean;
  sit(): void;
  /** Meters of the world in one of the user's. */
  scale(): number;
  /** To that, or from it to the size of a table. */
  changeSize(): void;
  home(): void;
  leave(): void;
}

/** As on a map: "1 : 45" of what is that much larger than it looks; "4 : 1" of what looks larger than it is. */
export function ratioOf(scale: number): string {
  const times = (factor: number) => (factor < 1e4 ? String(Number(factor.toPrecision(2))) : factor.toExponential(0).replace("+", ""));
  return scale < 1 ? `${times(1 / scale)} : 1` : `1 : ${times(scale)}`;
}

export function headsetCommands(acts: HeadsetActs): Entry[] {
  return [
    { name: "turn left", places: ["panel foot"], title: () => "Turn left", sign: () => signs.left, run: () => acts.turn(1) },
    { name: "turn right", places: ["panel foot"], title: () => "Turn right", sign: () => signs.right, run: () => acts.turn(-1) },
    { name: "go", places: ["panel foot"], title: () => "Go to ...", active: () => acts.teleportArmed(), run: () => acts.aimTeleport() },
    { name: "home in vr", places: ["panel foot"], title: () => "Home", run: () => acts.home() },
    {
      name: "turn by", places: ["panel foot"], title: () => (acts.turnBy() === 0 ? "Smooth" : `${acts.turnBy()}°`), run: () => acts.nextTurn(),
    },
    { name: "seated", places: ["panel foot"], title: () => "Seated", active: () => acts.seated(), run: () => acts.sit() },
    { name: "size", places: ["panel foot"], title: () => ratioOf(acts.scale()), active: () => acts.scale() === 1, run: () => acts.changeSize() },
    { name: "leave", places: ["panel foot"], title: () => "Leave", run: () => acts.leave() },
  ];
}
