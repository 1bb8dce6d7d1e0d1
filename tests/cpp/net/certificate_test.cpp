// SPDX-License-Identifier: Apache-2.0
#include "net/certificate.h"

#include "net/temporary_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace iota::net {
namespace {

namespace fs = std::filesystem;
using Hosts = std::vector<std::string>;
using test::TemporaryFolder;

const Hosts here{"localhost", "127.0.0.1", "192.168.0.2", "fe80::1"};

TEST(Certificate, is_new_each_time_and_its_fingerprint_with_it) {
  const Certificate one = make_certificate(here), other = make_certificate(here);
  EXPECT_NE(one.key, other.key);
  EXPECT_NE(fingerprint(one.chain), fingerprint(other.chain));
  EXPECT_EQ(fingerprint(one.chain).size(), 32U * 3 - 1);
  EXPECT_EQ(fingerprint(one.chain).find_first_not_of("0123456789ABCDEF:"), std::string::npos);
}

TEST(Certificate, is_refused_for_a_name_that_is_not_a_host) {
  EXPECT_THROW(make_certificate(Hosts{}), std::invalid_argument);
  EXPECT_THROW(make_certificate(Hosts{""}), std::invalid_argument);
  EXPECT_THROW(make_certificate(Hosts{"localhost,IP:1.2.3.4"}), std::invalid_argument);
  EXPECT_THROW(fingerprint("-----BEGIN CERTIFICATE-----\nAAAA\n-----END CERTIFICATE-----\n"), std::invalid_argument);
}

class KeptCertificate : public testing::Test {
 protected:
  Certificate load(const Hosts& hosts = here) const { return load_or_make_certificate(hosts, folder.path() / "iota"); }
  fs::path file() const { return folder.path() / "iota" / "certificate.pem"; }
  TemporaryFolder folder;
};

TEST_F(KeptCertificate, is_the_same_after_a_restart_and_for_fewer_hosts) {
  const std::string first = fingerprint(load().chain);
  EXPECT_EQ(fingerprint(load().chain), first);
  EXPECT_EQ(fingerprint(load({"192.168.0.2"}).chain), first);
}

TEST_F(KeptCertificate, is_made_anew_for_another_address) {
  const std::string first = fingerprint(load().chain);
  EXPECT_NE(fingerprint(load({"localhost", "192.168.0.3"}).chain), first);
}

TEST_F(KeptCertificate, is_readable_by_its_owner_only) {
  load();
  EXPECT_EQ(fs::status(file()).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(KeptCertificate, is_made_anew_where_any_part_of_the_file_is_damaged) {
  load();
  std::string text;
  std::getline(std::ifstream(file()), text, '\0');
  for (std::size_t cut = 0; cut < text.size(); cut += 37) {
    std::ofstream(file()) << text.substr(0, cut);
    const Certificate loaded = load();
    EXPECT_NO_THROW(fingerprint(loaded.chain));
    EXPECT_NE(loaded.key.find("PRIVATE KEY"), std::string::npos) << cut;
  }
}

TEST_F(KeptCertificate, is_made_anew_when_its_key_is_that_of_another) {
  load();
  const Certificate one = make_certificate(here), other = make_certificate(here);
  std::ofstream(file()) << one.chain << other.key;
  EXPECT_NE(fingerprint(load().chain), fingerprint(one.chain));
}

}  // namespace
}  // namespace iota::net
