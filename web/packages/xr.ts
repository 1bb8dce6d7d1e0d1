// SPDX-License-Identifier: Apache-2.0
export { offerHeadset } from "../src/xr/entry.ts";
export { Headset } from "../src/xr/headset.ts";
