#!/usr/bin/env node
// SPDX-License-Identifier: Apache-2.0
// Chromium, which says nothing of the messages of sockets. Playwright hears of each, asked or not, with what is in it, from its server to its
// client, too: sixty a second of each page took a quarter of the processor time of a test.

import { spawn } from "node:child_process";
import { Socket } from "node:net";

const unheard = Buffer.from('{"method":"Network.webSocketFrame');

// Playwright speaks to the third file, and hears the fourth: messages that end with a zero.
const chromium = spawn(process.env["CHROMIUM"] ?? "/usr/bin/chromium-headless-shell", process.argv.slice(2), { stdio: ["inherit", "inherit", "inherit", 3, "pipe"] });
const heard = new Socket({ fd: 4 });
let begun: Buffer = Buffer.alloc(0);
(chromium.stdio[4] as Socket).on("data", (read: Buffer) => {
  const data = begun.length === 0 ? read : Buffer.concat([begun, read]);
  let from = 0;
  for (let end = data.indexOf(0); end >= 0; end = data.indexOf(0, from)) {
    if (!data.subarray(from, from + unheard.length).equals(unheard)) heard.write(data.subarray(from, end + 1));
    from = end + 1;
  }
  begun = data.subarray(from);
});
chromium.on("exit", (code) => process.exit(code ?? 1));
