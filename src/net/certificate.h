// SPDX-License-Identifier: Apache-2.0
// The server's own certificate, for pages that come over the network: browsers give WebXR and clipboard to https only.
//
// It is signed by itself, so a browser warns at the first visit; its fingerprint tells the user that it is ours.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace iota::net {

/// Both in PEM. An empty chain: none.
struct Certificate {
  std::string chain;  ///< the server's own certificate first
  std::string key;
};

/// A new key on the curve P-256, signed by itself for 397 days (the most that browsers take), for host names and addresses.
/// Throws std::runtime_error where OpenSSL fails.
Certificate make_certificate(std::span<const std::string> hosts);

/// The one kept in `folder`/certificate.pem (mode 0600, written atomically). A new one takes its place when there is none, when it is
/// damaged, is not for one of the hosts, or ends within 30 days. Throws std::system_error when it cannot be written.
Certificate load_or_make_certificate(std::span<const std::string> hosts, const std::filesystem::path& folder);

/// SHA-256 of the first certificate of a chain as browsers show it: "12:AB:...". Throws std::invalid_argument for another text.
std::string fingerprint(std::string_view chain);

}  // namespace iota::net
