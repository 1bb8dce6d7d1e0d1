// SPDX-License-Identifier: Apache-2.0
// The server's own certificate, for pages over the network: browsers allow WebXR and clipboard on https only.
//
// It is self-signed, so a browser warns at the first visit; users can compare its fingerprint.
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

/// A new self-signed certificate on the curve P-256, valid for 397 days (the limit of browsers), for host names and
/// addresses. Throws std::runtime_error if OpenSSL fails.
Certificate make_certificate(std::span<const std::string> hosts);

/// The one kept in `folder`/certificate.pem (mode 0600, written atomically). It is replaced if there is none, if it is
/// damaged, is not for one of the hosts, or expires within 30 days. Throws std::system_error if it cannot be written.
Certificate load_or_make_certificate(std::span<const std::string> hosts, const std::filesystem::path& folder);

/// SHA-256 of the first certificate of a chain as browsers show it: "12:AB:...". Throws std::invalid_argument for another text.
std::string fingerprint(std::string_view chain);

}  // namespace iota::net
