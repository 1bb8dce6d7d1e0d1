// SPDX-License-Identifier: Apache-2.0
#include "net/access.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace iota::net {
namespace {

const Endpoint loopback{"127.0.0.1", "127.0.0.1", 8080};

TEST(Access, the_names_of_this_machine_with_our_port_are_taken) {
  for (const char* host : {"localhost:8080", "LOCALHOST:8080", "127.0.0.1:8080", "[::1]:8080", "localhost.:8080"}) {
    EXPECT_FALSE(refuse_host(host, loopback)) << host;
  }
  EXPECT_FALSE(refuse_host("desk.local:8080", {"desk.local", "192.168.1.5", 8080}));
  EXPECT_FALSE(refuse_host("192.168.1.5:8080", {"0.0.0.0", "192.168.1.5", 8080}));
  EXPECT_FALSE(refuse_host("[fe80::1]:8080", {"::", "fe80::1", 8080}));
  EXPECT_FALSE(refuse_host("localhost", {"127.0.0.1", "127.0.0.1", 80}));
}

TEST(Access, other_hosts_and_ports_are_refused) {
  for (const char* host : {"", ":8080", "evil.example:8080", "localhost", "localhost:8081",
                           "localhost:", "localhost:8080x", "127.0.0.1.evil.example:8080", "localhost:808080",
                           "evil.example@localhost:8080", "127.0.0.1 :8080", "[::1]", "[::1", "::1:8080"}) {
    EXPECT_TRUE(refuse_host(host, loopback)) << host;
  }
}

TEST(Access, only_our_own_page_is_an_origin) {
  EXPECT_FALSE(refuse_origin("http://localhost:8080", Scheme::http, "localhost:8080"));
  EXPECT_FALSE(refuse_origin("HTTP://LocalHost:8080", Scheme::http, "localhost:8080"));
  EXPECT_FALSE(refuse_origin("http://localhost", Scheme::http, "localhost:80"));
  for (const char* origin :
       {"null", "", "https://localhost:8080", "http://localhost:8081", "http://127.0.0.1:8080", "http://evil.example",
        "http://localhost:8080.evil.example", "http://localhost:8080/", "localhost:8080"}) {
    EXPECT_TRUE(refuse_origin(origin, Scheme::http, "localhost:8080")) << origin;
  }
}

TEST(Access, targets_are_taken_apart_and_unescaped) {
  const auto target = parse_target("/a%20b/c.js?token=x%2By&z=1#part");
  ASSERT_TRUE(target);
  EXPECT_EQ(target->path, "/a b/c.js");
  EXPECT_EQ(query_value(target->query, "token"), "x+y");
  EXPECT_EQ(query_value(target->query, "z"), "1");
  EXPECT_EQ(query_value(target->query, "to"), "");
  EXPECT_EQ(query_value("", "token"), "");
  EXPECT_EQ(query_value("&&token=&token=2", "token"), "");
}

TEST(Access, malformed_targets_are_refused) {
  for (const char* target : {"", "*", "a", "http://localhost/", "/%", "/%2", "/%zz", "/%-1"}) {
    EXPECT_FALSE(parse_target(target)) << target;
  }
}

TEST(Access, over_https_the_page_and_its_port_are_those_of_https) {
  EXPECT_FALSE(refuse_origin("https://192.168.0.2:8080", Scheme::https, "192.168.0.2:8080"));
  EXPECT_FALSE(refuse_origin("https://192.168.0.2", Scheme::https, "192.168.0.2:443"));
  EXPECT_TRUE(refuse_origin("http://192.168.0.2:8080", Scheme::https, "192.168.0.2:8080"));
  EXPECT_TRUE(refuse_origin("https://192.168.0.2:8080", Scheme::http, "192.168.0.2:8080"));
  EXPECT_FALSE(refuse_host("192.168.0.2", {"0.0.0.0", "192.168.0.2", 443, Scheme::https}));
  EXPECT_TRUE(refuse_host("192.168.0.2", {"0.0.0.0", "192.168.0.2", 443}));
}

TEST(Access, a_proxy_in_front_may_pass_on_its_own_name_and_no_other) {
  const Endpoint behind{"127.0.0.1", "127.0.0.1", 8080, Scheme::http, "https://worlds.example.org"};
  EXPECT_FALSE(refuse_host("worlds.example.org", behind));
  EXPECT_FALSE(refuse_host("WORLDS.example.org", behind));
  EXPECT_FALSE(refuse_host("localhost:8080", behind));
  EXPECT_TRUE(refuse_host("worlds.example.org:444", behind));
  EXPECT_TRUE(refuse_host("evil.example", behind));
  const auto refuse = [&](const char* origin, const char* host) {
    return refuse_origin(origin, Scheme::http, host, behind.public_origin).has_value();
  };
  EXPECT_FALSE(refuse("https://worlds.example.org", "worlds.example.org"));
  EXPECT_FALSE(refuse("http://localhost:8080", "localhost:8080"));
  EXPECT_TRUE(refuse("https://evil.example", "worlds.example.org"));
  EXPECT_TRUE(refuse("https://worlds.example.org", "localhost:8080")) << "a page of the proxy asks this machine itself";
}

TEST(Access, a_public_address_is_a_scheme_and_a_name) {
  EXPECT_EQ(checked_origin("HTTPS://Worlds.example.org"), "https://worlds.example.org");
  EXPECT_EQ(checked_origin("http://10.0.0.1:8000"), "http://10.0.0.1:8000");
  for (const char* wrong : {"", "worlds.example.org", "https://", "https://a/b", "https://a/", "https://a b", "ftp://a",
                            "https://a;b", "https://a:port"})
    EXPECT_THROW(checked_origin(wrong), std::invalid_argument) << wrong;
}

}  // namespace
}  // namespace iota::net
