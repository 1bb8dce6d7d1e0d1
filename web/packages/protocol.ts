// SPDX-License-Identifier: Apache-2.0
export * from "../src/protocol/generated.ts";
export { Connection, type ConnectionListener, type JoinRequest, type LinkState } from "../src/net/connection.ts";
export { takeToken } from "../src/net/token.ts";
