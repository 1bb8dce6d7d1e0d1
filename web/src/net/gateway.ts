// SPDX-License-Identifier: Apache-2.0
// Rooms on several machines: the server that knows on which one a room is, also after it has moved.

/** The answer of the server, see python/iota/rooms/serving.py. url: empty while the room starts. */
export interface Whereabouts {
  readonly url: string;
  readonly state: string;
  readonly trouble: string;
}

/** Rejects with a sentence for users if nobody answers, or the link is not of the room. */
export async function whereIs(gateway: string, room: string, token: string): Promise<Whereabouts> {
  let answer: Response;
  try {
    answer = await fetch(`${gateway}/rooms/where?${new URLSearchParams({ room, token }).toString()}`, { cache: "no-store" });
  } catch {
    throw new Error("The list of rooms does not answer. It is asked again.");
  }
  if (!answer.ok) throw new Error((await answer.text()).trim());
  return (await answer.json()) as Whereabouts;
}

/** The address to go to from the page at `here`, with the rest of its query; null if the room is still there. */
export function addressAfterMove(here: URL, url: string, name: string): string | null {
  if (url === "") return null;
  const there = new URL(url);
  if (there.origin === here.origin && there.pathname === here.pathname) return null;
  for (const [key, value] of here.searchParams) if (!there.searchParams.has(key)) there.searchParams.set(key, value);
  if (name !== "") there.searchParams.set("name", name); // another origin keeps another name
  return there.href;
}

/** Called when the connection is lost: goes to where the room is now. `token`: of this page. */
export function followerOf(here: URL, token: string | null, go: (url: string) => void): ((name: string) => void) | null {
  const gateway = here.searchParams.get("rooms");
  const room = here.searchParams.get("room");
  if (gateway === null || room === null || token === null) return null;
  let isAsking = false;
  return (name) => {
    if (isAsking) return;
    isAsking = true;
    whereIs(gateway, room, token).then(({ url }) => {
      const there = addressAfterMove(here, url, name);
      if (there !== null) go(there);
    }, () => undefined).finally(() => (isAsking = false));
  };
}
