// SPDX-License-Identifier: Apache-2.0
// Starts the page, in a document with the elements of page.html.
import "../src/ui/page.css";
import "../src/ui/panel.css";
import "../src/app/main.ts";

export type { IotaDebug } from "../src/app/debug.ts";
