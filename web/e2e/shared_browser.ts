// SPDX-License-Identifier: Apache-2.0
// Starts the one browser of a run before its first test, and ends it after the last one.

import { chromium } from "playwright-core";
import { launchOptions, sharedBrowser } from "./browser.ts";

export default async function start(): Promise<() => Promise<void>> {
  const server = await chromium.launchServer(launchOptions);
  process.env[sharedBrowser] = server.wsEndpoint();
  return () => server.close();
}
