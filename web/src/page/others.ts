// SPDX-License-Identifier: Apache-2.0
import type { PageListener } from "./events.ts";
import type { PageParts } from "./page_parts.ts";

/** Other users, fetched with the first one. They also tell where the own user is, for which a step with a budget is reason enough. */
export function othersOf({ world, session, viewer }: Pick<PageParts, "world" | "session" | "viewer">): PageListener {
  let asked = false;
  return {
    changed: (what) => {
      if (asked || (what !== "clients" && what !== "budget")) return;
      if (world.budgetMs === 0 && world.clients.every(({ client }) => client === session.clientId)) return;
      asked = true;
      void import("./people.ts").then(({ People }) => {
        viewer.add(new People(world, session, viewer));
        viewer.invalidate();
      });
    },
  };
}
