// SPDX-License-Identifier: Apache-2.0
// Plays a recording without a server: a page of `iota record NAME -o FILE.html` or `iota play`. Users can look around, stop and go to any time,
// but not grab.

import "./player.css";
import { makeDebug } from "../app/debug.ts";
import { ScreenInput } from "../interact/screen_input.ts";
import { makePage, type Page } from "../page/page.ts";
import { Resolution } from "../page/resolution.ts";
import { MessageType, Role } from "../protocol/generated.ts";
import { byId, make } from "../ui/dom.ts";
import { Playback, readFrames } from "./recording.ts";

/** Replaces a connection: ignores messages of the page, and gets those of the playback. */
class RecordedSocket {
  static readonly OPEN = 1;
  static current: RecordedSocket | null = null;
  static begin: () => void = () => {};
  static ping: () => void = () => {};

  binaryType = "arraybuffer";
  readyState = 1;
  onopen: (() => void) | null = null;
  onmessage: ((event: { data: ArrayBuffer }) => void) | null = null;
  onclose: (() => void) | null = null;

  constructor() {
    RecordedSocket.current = this;
    queueMicrotask(() => this.onopen?.());
  }

  /** The page sends hello first; its later messages need no answer, except pings. */
  send(data: Uint8Array): void {
    const type: number = data[0];
    if (type === MessageType.hello) queueMicrotask(RecordedSocket.begin);
    else if (type === MessageType.ping) queueMicrotask(RecordedSocket.ping);
  }

  close(): void {
    this.readyState = 3;
  }
}

async function unpack(text: string): Promise<Uint8Array> {
  const packed = Uint8Array.from(atob(text.trim()), (letter) => letter.codePointAt(0)!);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

function addControls(playback: Playback): () => void {
  const bar = byId("player", HTMLElement);
  const button = make("button");
  const slider = make("input");
  slider.type = "range";
  slider.max = String(playback.duration);
  slider.step = "any";
  slider.setAttribute("aria-label", "Time");
  const time = make("span");
  bar.append(button, slider, time);
  const toggle = () => { playback.playing = !playback.playing; };
  button.addEventListener("click", toggle);
  window.addEventListener("keydown", (event) => {
    if (event.key !== " ") return;
    event.preventDefault();
    toggle();
  });
  slider.addEventListener("input", () => playback.seek(Number(slider.value)));
  return () => {
    button.textContent = playback.playing ? "Pause" : "Play";
    slider.value = String(playback.position);
    time.textContent = `${playback.position.toFixed(1)} / ${playback.duration.toFixed(1)} s`;
  };
}

/** Recordings carry no code, so that playing one is safe: tells the user what is therefore missing. */
function tellLeftOut({ events, world }: Page): void {
  const note = make("p", "note");
  note.hidden = true;
  document.body.append(note);
  events.add({
    changed: (what) => {
      if (what !== "settings") return;
      const names = world.settings.modules.map((path) => path.slice(path.lastIndexOf("/") + 1));
      note.hidden = names.length === 0;
      note.textContent = `Not in this recording: what the script's own code draws (${names.join(", ")}).`;
    },
  });
}

async function main(): Promise<void> {
  const frames = readFrames(await unpack(byId("recording", HTMLElement).textContent ?? ""));
  const playback = new Playback(frames, (data) => RecordedSocket.current?.onmessage?.({ data }));
  RecordedSocket.begin = () => playback.seek(0);
  RecordedSocket.ping = () => playback.repeat();
  window.WebSocket = RecordedSocket as unknown as typeof WebSocket;

  const canvas = byId("view", HTMLCanvasElement);
  const page = makePage(canvas, "ws://recording/", { world: "", role: Role.viewer, name: "" });
  const input = new ScreenInput(canvas, page.viewer.camera, page.gestures, page.navigation, {
    clickNothing: () => {}, openMenu: () => {}, closeMenu: () => {}, active: () => {},
  });
  const theme = matchMedia("(prefers-color-scheme: dark)");
  page.setTheme(theme.matches ? "dark" : "light");
  theme.addEventListener("change", () => page.setTheme(theme.matches ? "dark" : "light"));
  const show = addControls(playback);
  tellLeftOut(page);
  page.viewer.add(new Resolution(page.viewer), {
    update: (seconds) => {
      playback.pass(seconds);
      show();
    },
    aim: () => input.aim(),
  });
  window.iota = makeDebug(page, canvas);
  page.start();
}

main().catch((error: unknown) => {
  const card = make("p", "failure", `This recording cannot be played: ${error instanceof Error ? error.message : String(error)}`);
  document.body.append(card);
});
