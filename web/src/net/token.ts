// SPDX-License-Identifier: Apache-2.0
// The secret of the page's address. It is removed from the address bar, where others may read it on a shared screen,
// and kept for this tab only, so that a reload still has it.

// Behind a proxy several worlds have one origin, each a folder.
const folder = new URL(".", location.href).pathname;
const key = folder === "/" ? "iota token" : `iota token ${folder}`;

/** The token that this page was opened with, or null. */
export function takeToken(): string | null {
  const url = new URL(location.href);
  const given = url.searchParams.get("token");
  try {
    if (given === null) return sessionStorage.getItem(key);
    sessionStorage.setItem(key, given);
  } catch {
    return given; // Without storage a reload needs it in the address.
  }
  url.searchParams.delete("token");
  history.replaceState(history.state, "", url);
  return given;
}
