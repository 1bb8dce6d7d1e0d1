// SPDX-License-Identifier: Apache-2.0
// The page's own commands, in the order in which the bar, the help and the wrist panel show them. A new one is one entry here.

import type { Choice, Command, Entry, ScriptCommand } from "../commands/command.ts";
import { ActionTarget, ControlCommand, ControllerButton, NoticeLevel, Role, type ActionEntry } from "../protocol/generated.ts";
import type { PageParts } from "./page_parts.ts";

/** Times real time. */
const speeds: readonly number[] = [0.1, 0.25, 0.5, 1, 2];

const signs = {
  studies: "M5 5h6v6h-6zM14 5h6v6h-6zM5 14h6v6h-6zM14 14h6v6h-6z",
  play: "M8 5l11 7-11 7z",
  pause: "M8 5v14M16 5v14",
  step: "M6 5l9 7-9 7zM18 5v14",
  reset: "M5 5v5h5M5.6 10A7.5 7.5 0 1 1 4.6 14",
  several: "M5 8V5h3M16 5h3v3M19 16v3h-3M8 19H5v-3M11 5h2M11 19h2M5 11v2M19 11v2",
  minus: "M6 12h12",
  plus: "M6 12h12M12 6v12",
};

export function pageCommands({ world, session, selection, viewer, navigation, framing, viewpoints, sound, events }: PageParts): Entry[] {
  const say = (key: string, title: string) => events.notice({ level: NoticeLevel.info, title, text: "", hint: "", key });
  const refusal = () => session.refusal(Role.host);
  /** A command that is for all pages at once. */
  const forHosts = (command: Command): Command => ({
    ...command, refusal, run: (key) => (refusal() === "" ? command.run(key) : say("refusal", refusal())),
  });
  /** The next faster (1) or slower (-1) of the offered speeds. */
  const changeSpeed = (direction: 1 | -1) => {
    const now = world.speed;
    const next = direction > 0 ? speeds.find((speed) => speed > now * 1.01) : speeds.findLast((speed) => speed < now * 0.99);
    if (next !== undefined) session.control(ControlCommand.speed, next);
  };
  const speed: Choice = {
    name: "speed",
    places: ["bar", "panel"],
    title: () => "Speed ([ and ])",
    options: speeds.map(String),
    unit: "×",
    refusal,
    value: () => String(Number(world.speed.toPrecision(2))),
    choose: (option) => session.control(ControlCommand.speed, Number(option)),
  };
  const commands: Entry[] = [
    {
      name: "studies",
      places: ["bar"],
      title: () => "All studies",
      sign: () => signs.studies,
      // A gallery serves the page by this name, and itself as /.
      offered: () => location.pathname.endsWith("/world.html"),
      run: () => location.assign("./"),
    },
    forHosts({
      name: "play",
      help: "pause, play",
      keys: [" "],
      places: ["bar", "panel"],
      title: () => (world.paused ? "Play" : "Pause"),
      sign: () => (world.paused ? signs.play : signs.pause),
      run: () => session.control(world.paused ? ControlCommand.play : ControlCommand.pause),
    }),
    forHosts({
      name: "step",
      help: "one step",
      keys: ["."],
      repeats: true,
      places: ["bar", "panel"],
      title: () => "Single step",
      sign: () => signs.step,
      run: () => {
        if (!world.paused) session.control(ControlCommand.pause);
        session.control(ControlCommand.singleStep);
      },
    }),
    forHosts({
      name: "reset",
      help: "reset",
      keys: ["r"],
      places: ["bar", "panel"],
      title: () => "Reset",
      sign: () => signs.reset,
      run: () => session.control(ControlCommand.reset),
    }),
    forHosts({
      name: "slower",
      help: "slower, faster",
      keys: ["["],
      repeats: true,
      places: ["panel"],
      narrow: true,
      title: () => "Slower",
      sign: () => signs.minus,
      run: () => changeSpeed(-1),
    }),
    speed,
    forHosts({
      name: "faster",
      help: "slower, faster",
      keys: ["]"],
      repeats: true,
      places: ["panel"],
      narrow: true,
      title: () => "Faster",
      sign: () => signs.plus,
      run: () => changeSpeed(1),
    }),
    {
      name: "style",
      help: "next style",
      keys: ["l"],
      places: ["bar", "panel"],
      title: () => `Style: ${world.style}`,
      label: () => world.style,
      offered: () => world.settings.styles.length > 1,
      run: () => {
        const { styles } = world.settings;
        if (styles.length > 0) world.setStyle(styles[(styles.indexOf(world.style) + 1) % styles.length]);
      },
    },
    {
      name: "fly",
      help: "a drag on empty space looks around instead of orbiting",
      keys: ["f"],
      title: () => "Fly",
      active: () => navigation.flying,
      run: () => {
        navigation.flying = !navigation.flying;
        say("fly", navigation.flying ? "Fly: drag looks around, w a s d q e walk" : "Orbit: drag turns the view");
      },
    },
    {
      name: "home",
      help: "back to the first view",
      keys: ["Home", "0"],
      title: () => "First view",
      run: () => framing.home(),
    },
    {
      name: "viewpoint",
      help: "viewpoints of the world",
      keys: ["1", "2", "3", "4", "5", "6", "7", "8", "9"],
      places: ["bar", "panel"],
      title: () => "Next viewpoint (1 to 9)",
      label: () => viewpoints.name || "view",
      offered: () => viewpoints.count > 0,
      run: (key) => (key === undefined ? viewpoints.next() : viewpoints.go(Number(key) - 1)),
    },
    {
      name: "follow",
      help: "follows the selected body, or stays",
      keys: ["j"],
      title: () => "Follow",
      active: () => viewpoints.followed >= 0,
      run: () => {
        const body = viewpoints.followed >= 0 ? -1 : selection.actionBody;
        viewpoints.follow(body);
        say("follow", body >= 0 ? "The view follows" : "The view stays");
      },
    },
    {
      name: "grid",
      help: "grid: fine lines, and stronger ones each ten",
      keys: ["g"],
      title: () => "Grid",
      active: () => viewer.stage.gridShown,
      run: () => {
        viewer.stage.gridShown = !viewer.stage.gridShown;
        if (viewer.stage.gridShown) say("grid", `Fine lines each ${lengthName(viewer.stage.gridCell)}, stronger ones each ten`);
        viewer.invalidate();
      },
    },
    {
      name: "picture",
      help: "saves a picture",
      keys: ["p"],
      title: () => "Picture",
      run: () => void import("./picture.ts").then(({ savePicture }) => savePicture(viewer, world.settings.title)).catch((error: unknown) => say("picture", String(error))),
    },
    {
      name: "sound",
      help: "sound on, off",
      keys: ["m"],
      title: () => "Sound",
      active: () => !sound.muted,
      run: () => {
        sound.muted = !sound.muted;
        say("sound", sound.muted ? "Sound is off" : "Sound is on");
      },
    },
    {
      name: "select next",
      help: "selects the next body",
      keys: ["ArrowRight", "ArrowDown"],
      repeats: true,
      title: () => "Next body",
      run: () => selection.selectNext(1),
    },
    {
      name: "select previous",
      help: "selects the previous body",
      keys: ["ArrowLeft", "ArrowUp"],
      repeats: true,
      title: () => "Previous body",
      run: () => selection.selectNext(-1),
    },
    {
      name: "select several",
      help: "a drag on nothing selects all within, a press adds one; so do Ctrl and a drag, Ctrl and a click",
      keys: ["o"],
      places: ["bar", "panel foot"],
      title: () => "Select several",
      sign: () => signs.several,
      // Without a keyboard there is no Ctrl.
      offered: () => viewer.presenting || matchMedia("(pointer: coarse)").matches,
      active: () => navigation.banding,
      run: () => {
        selection.adding = navigation.banding = !navigation.banding;
        say("band", navigation.banding ? "A press adds a body, a drag on nothing selects all within" : "A press selects one body");
      },
    },
    {
      name: "select nothing",
      help: "selects nothing",
      keys: ["Escape"],
      title: () => "Nothing",
      run: () => selection.select(-1),
    },
  ];
  return commands;
}

/** "10 cm" for 0.1 m. */
function lengthName(meters: number): string {
  const units: readonly (readonly [number, string])[] = [[1e3, "km"], [1, "m"], [1e-2, "cm"], [1e-3, "mm"], [1e-6, "µm"], [1e-9, "nm"]];
  const [unit, name] = units.find(([size]) => meters > 0.99 * size) ?? [1e-12, "pm"];
  return `${Number((meters / unit).toPrecision(2))} ${name}`;
}

const faceButtons = { [ControllerButton.none]: null, [ControllerButton.a]: "a", [ControllerButton.b]: "b" } as const;

/** The script's actions as commands. */
export function scriptCommands(actions: readonly ActionEntry[], { session, selection, events }: PageParts): ScriptCommand[] {
  return actions.map((action): ScriptCommand => {
    const onBody = action.on === ActionTarget.body;
    const refusal = () => session.refusal(Role.actor);
    const act = (bodies: readonly number[]) => {
      if (refusal() === "") session.act(action.name, bodies);
      else events.notice({ level: NoticeLevel.info, title: refusal(), text: "", hint: "", key: "refusal" });
    };
    const command: Command = {
      name: `action ${action.name}`,
      help: action.help,
      keys: action.key === "" ? [] : [action.key],
      title: () => action.label,
      offered: () => !onBody || selection.selected >= 0,
      enabled: () => !onBody || selection.actionBody >= 0,
      refusal,
      run: () => act(onBody ? selection.actionBodies : [selection.actionBody].filter((body) => body >= 0)),
    };
    return { ...command, onBody, button: faceButtons[action.button], runOn: (body) => act([body]) };
  });
}
