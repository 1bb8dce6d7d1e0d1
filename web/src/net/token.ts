// SPDX-License-Identifier: Apache-2.0
// The secret of the page's address. It is taken out of the address bar, where others may read it over a shoulder or on a shared
// screen, and kept for this tab only, so that a reload still knows it.

const key = "iota token";

/** The token that this page was opened with, or null where it never had one. */
export function takeToken(): string | null {
  const url = new URL(location.href);
  const given = url.searchParams.get("token");
  try {
    if (given === null) return sessionStorage.getItem(key);
    sessionStorage.setItem(key, given);
  } catch {
    return given; // Without storage a reload needs the address as it is.
  }
  url.searchParams.delete("token");
  history.replaceState(history.state, "", url);
  return given;
}
