// SPDX-License-Identifier: Apache-2.0
// A real `iota run ...` for a test, on a port of its own, with a state folder of its own.

import { execFileSync, spawn, type ChildProcess } from "node:child_process";
import { existsSync, mkdtempSync } from "node:fs";
import { createServer } from "node:net";
import { tmpdir } from "node:os";
import path from "node:path";
import { createInterface } from "node:readline";

const root = path.resolve(import.meta.dirname, "..", "..");
const iota = path.join(root, ".venv", "bin", "iota");
const startsWithinMs = 60_000;

export const artifacts = path.join(root, "build", "artifacts");
export const probe = path.join(import.meta.dirname, "chain_probe.py");

/** The names that `iota list` shows. */
export function studyNames(): string[] {
  return execFileSync(iota, ["list"], { encoding: "utf8" }).split("\n").flatMap((line) => /^\S+/.exec(line)?.[0] ?? []);
}

export async function freePort(): Promise<number> {
  return new Promise((resolve, reject) => {
    const server = createServer();
    server.on("error", reject);
    server.listen(0, "127.0.0.1", () => {
      const address = server.address();
      server.close(() => (typeof address === "object" && address !== null ? resolve(address.port) : reject(new Error("no port"))));
    });
  });
}

export class WorldServer {
  readonly port: number;
  /** The page's address with its token. */
  readonly url: string;
  /** The JSON objects that the script has printed, oldest first. */
  readonly reports: readonly object[];
  private readonly process_: ChildProcess;
  private readonly lines_: string[];

  private constructor(port: number, url: string, process: ChildProcess, lines: string[], reports: object[]) {
    this.port = port;
    this.url = url;
    this.process_ = process;
    this.lines_ = lines;
    this.reports = reports;
  }

  /** Starts `iota run WHAT` and waits for its address. The state folder keeps the token over a restart. */
  static async start(
    what: readonly string[], port: number, stateFolder = mkdtempSync(path.join(tmpdir(), "iota-state-")), environment: Readonly<Record<string, string>> = {},
  ): Promise<WorldServer> {
    if (!existsSync(iota)) throw new Error(`${iota} is missing: run make build first`);
    const process_ = spawn(iota, ["run", ...what, "--no-open", "--port", String(port)], {
      cwd: root, env: { ...process.env, ...environment, XDG_STATE_HOME: stateFolder, PYTHONUNBUFFERED: "1" },
    });
    const lines: string[] = [];
    const reports: object[] = [];
    const url = await new Promise<string>((resolve, reject) => {
      const timer = setTimeout(() => reject(new Error(`no address after ${startsWithinMs} ms:\n${lines.join("\n")}`)), startsWithinMs);
      const take = (line: string) => {
        lines.push(line);
        if (line.startsWith("{")) reports.push(JSON.parse(line) as object);
        const found = /https?:\/\/\S*[?&]token=\S+/.exec(line);
        if (found === null) return;
        clearTimeout(timer);
        resolve(found[0]);
      };
      for (const input of [process_.stdout, process_.stderr]) createInterface({ input }).on("line", take);
      process_.on("exit", (code) => {
        clearTimeout(timer);
        reject(new Error(`iota run ended with ${code}:\n${lines.join("\n")}`));
      });
    });
    return new WorldServer(port, url, process_, lines, reports);
  }

  /** The newest of them. */
  get report(): { articulates: number; held: number; structure_version: number } | null {
    return (this.reports.at(-1) ?? null) as { articulates: number; held: number; structure_version: number } | null;
  }

  get pid(): number {
    if (this.process_.pid === undefined) throw new Error("iota run has not started");
    return this.process_.pid;
  }

  get output(): string {
    return this.lines_.join("\n");
  }

  /** Whether it still runs, and what it has printed at last besides reports: for the message of a test that fails. */
  get state(): string {
    const { exitCode, signalCode } = this.process_;
    const said = this.lines_.filter((line) => !line.startsWith("{")).slice(-5).join(" | ");
    return `${exitCode === null && signalCode === null ? "running" : `ended with ${exitCode ?? signalCode}`}; it said: ${said}; its last report: ${JSON.stringify(this.report)}`;
  }

  async stop(signal: NodeJS.Signals = "SIGINT"): Promise<void> {
    if (this.process_.exitCode !== null || this.process_.signalCode !== null) return;
    await new Promise<void>((resolve) => {
      const hard = setTimeout(() => this.process_.kill("SIGKILL"), 4000);
      this.process_.on("exit", () => {
        clearTimeout(hard);
        resolve();
      });
      this.process_.kill(signal);
    });
  }
}
