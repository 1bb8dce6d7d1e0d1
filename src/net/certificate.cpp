// SPDX-License-Identifier: Apache-2.0
#include "net/certificate.h"

#include "net/secret_file.h"

#include <openssl/bio.h>
#include <openssl/ec.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rand.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include <array>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

namespace iota::net {
namespace {

constexpr long day = 24 * 60 * 60;  // s
constexpr long valid_time = 397 * day;
constexpr long renewal_time = 30 * day;  // before its end

template <auto Free>
struct Freed {
  template <class T>
  void operator()(T* object) const {
    Free(object);
  }
};
using Key = std::unique_ptr<EVP_PKEY, Freed<EVP_PKEY_free>>;
using X509Certificate = std::unique_ptr<X509, Freed<X509_free>>;
using Memory = std::unique_ptr<BIO, Freed<BIO_free_all>>;
using Extension = std::unique_ptr<X509_EXTENSION, Freed<X509_EXTENSION_free>>;

/// Throws with OpenSSL's reason, if something failed.
void require(bool is_done, const char* what) {
  if (is_done) return;
  std::array<char, 256> reason{};
  ERR_error_string_n(ERR_get_error(), reason.data(), reason.size());
  ERR_clear_error();
  throw std::runtime_error(std::string("cannot make a certificate: ") + what + ": " + reason.data());
}

Memory read_only(std::string_view text) {
  Memory memory(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
  require(memory != nullptr, "memory");
  return memory;
}

template <class Write>
std::string as_pem(Write write) {
  Memory memory(BIO_new(BIO_s_mem()));
  require(memory && write(memory.get()) == 1, "PEM");
  char* data = nullptr;
  const long size = BIO_get_mem_data(memory.get(), &data);
  return {data, static_cast<std::size_t>(size)};
}

/// Null if the text is not a certificate.
X509Certificate parse_certificate(std::string_view pem) {
  X509Certificate certificate(PEM_read_bio_X509(read_only(pem).get(), nullptr, nullptr, nullptr));
  ERR_clear_error();
  return certificate;
}

Key parse_key(std::string_view pem) {
  Key key(PEM_read_bio_PrivateKey(read_only(pem).get(), nullptr, nullptr, nullptr));
  ERR_clear_error();
  return key;
}

bool is_address(const std::string& host) {
  ASN1_OCTET_STRING* address = a2i_IPADDRESS(host.c_str());
  ERR_clear_error();
  ASN1_OCTET_STRING_free(address);
  return address != nullptr;
}

bool is_for(X509* certificate, const std::string& host) {
  return is_address(host) ? X509_check_ip_asc(certificate, host.c_str(), 0) == 1
                          : X509_check_host(certificate, host.data(), host.size(), 0, nullptr) == 1;
}

bool lasts(X509* certificate) {
  std::time_t limit = std::time(nullptr) + renewal_time;
  return X509_cmp_time(X509_get0_notAfter(certificate), &limit) > 0;
}

void add_extension(X509* certificate, int id, const std::string& value) {
  X509V3_CTX context;
  X509V3_set_ctx_nodb(&context);
  X509V3_set_ctx(&context, certificate, certificate, nullptr, nullptr, 0);
  const Extension extension(X509V3_EXT_conf_nid(nullptr, &context, id, value.c_str()));
  require(extension && X509_add_ext(certificate, extension.get(), -1) == 1, value.c_str());
}

/// "DNS:localhost,IP:127.0.0.1"
std::string alternative_names(std::span<const std::string> hosts) {
  std::string names;
  for (const std::string& host : hosts) {
    // A comma would start another entry.
    if (host.empty() || host.find(',') != std::string::npos)
      throw std::invalid_argument("'" + host + "' is not a host");
    names += (names.empty() ? "" : ",") + std::string(is_address(host) ? "IP:" : "DNS:") + host;
  }
  if (names.empty()) throw std::invalid_argument("a certificate needs a host");
  return names;
}

void set_serial(X509* certificate) {
  std::uint64_t serial = 0;
  require(RAND_bytes(reinterpret_cast<unsigned char*>(&serial), sizeof serial) == 1, "random number");
  require(ASN1_INTEGER_set_uint64(X509_get_serialNumber(certificate), serial >> 1) == 1, "serial number");
}

void set_name(X509* certificate) {
  X509_NAME* name = X509_get_subject_name(certificate);
  const auto* text = reinterpret_cast<const unsigned char*>("Iota on this machine");
  require(X509_NAME_add_entry_by_txt(name, "CN", MBSTRING_ASC, text, -1, -1, 0) == 1, "name");
  require(X509_set_issuer_name(certificate, name) == 1, "issuer");
}

/// The kept certificate, or an empty one if it cannot be used.
Certificate usable(const std::string& text, std::span<const std::string> hosts) {
  const X509Certificate certificate = parse_certificate(text);
  const Key key = parse_key(text);
  if (!certificate || !key || X509_check_private_key(certificate.get(), key.get()) != 1 || !lasts(certificate.get()))
    return {};
  for (const std::string& host : hosts) {
    if (!is_for(certificate.get(), host)) return {};
  }
  return {text, text};  // OpenSSL finds both parts in one text
}

}  // namespace

Certificate make_certificate(std::span<const std::string> hosts) {
  const std::string names = alternative_names(hosts);
  const Key key(EVP_EC_gen("P-256"));
  require(key != nullptr, "key");
  const X509Certificate certificate(X509_new());
  require(certificate && X509_set_version(certificate.get(), X509_VERSION_3) == 1, "version");
  set_serial(certificate.get());
  set_name(certificate.get());
  // Valid from yesterday, as the clock of a phone or headset may be late.
  require(X509_gmtime_adj(X509_getm_notBefore(certificate.get()), -day) != nullptr, "begin");
  require(X509_gmtime_adj(X509_getm_notAfter(certificate.get()), valid_time - day) != nullptr, "end");
  require(X509_set_pubkey(certificate.get(), key.get()) == 1, "public key");
  add_extension(certificate.get(), NID_subject_alt_name, names);
  add_extension(certificate.get(), NID_basic_constraints, "critical,CA:FALSE");
  add_extension(certificate.get(), NID_ext_key_usage, "serverAuth");
  require(X509_sign(certificate.get(), key.get(), EVP_sha256()) > 0, "signature");
  return {as_pem([&](BIO* out) { return PEM_write_bio_X509(out, certificate.get()); }), as_pem([&](BIO* out) {
            return PEM_write_bio_PrivateKey(out, key.get(), nullptr, nullptr, 0, nullptr, nullptr);
          })};
}

Certificate load_or_make_certificate(std::span<const std::string> hosts, const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "certificate.pem";
  if (Certificate kept = usable(read_file(file), hosts); !kept.chain.empty()) return kept;
  Certificate made = make_certificate(hosts);
  replace_secret(file, made.chain + made.key);
  return made;
}

std::string fingerprint(std::string_view chain) {
  const X509Certificate certificate = parse_certificate(chain);
  if (!certificate) throw std::invalid_argument("this is not a certificate in PEM");
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned size = 0;
  require(X509_digest(certificate.get(), EVP_sha256(), digest.data(), &size) == 1, "fingerprint");
  std::string text;
  for (unsigned i = 0; i < size; ++i) {
    constexpr const char* digits = "0123456789ABCDEF";
    if (i > 0) text += ':';
    text += {digits[digest[i] >> 4], digits[digest[i] & 15]};
  }
  return text;
}

}  // namespace iota::net
