// SPDX-License-Identifier: Apache-2.0
// A world of another process, for which another server on this machine stands.
#include "net/relay.h"

#include "net/server.h"
#include "tests/cpp/net/page_client.h"

#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <variant>

namespace iota::net {
namespace {

using test::PageClient;

class RelayTest : public testing::Test {
 protected:
  RelayTest() { room_ = other_.open("chain"); }

  static ServerOptions options(const std::string& name) {
    ServerOptions given;
    given.port = 0;
    given.token = name + "-host";
    given.other_tokens = {{name + "-guest", protocol::Role::actor}, {name + "-viewer", protocol::Role::viewer}};
    return given;
  }
  void relay() { gallery_.relay("chain", other_.port(), {"other-guest", "other-viewer", "other-host"}); }
  std::string target(const std::string& role) const { return "/ws?token=gallery-" + role + "&world=chain"; }

  /// The role of a client that joins by the gallery; none if it is not let in.
  std::optional<protocol::Role> join(PageClient& client, const std::string& role) const {
    if (client.connect(gallery_.port(), target(role)) != 101) return std::nullopt;
    client.send(protocol::encode(
        protocol::Hello{protocol::protocol_magic, protocol::protocol_version, "chain", protocol::Role::actor, role}));
    while (const auto frame = client.receive()) {
      const auto decoded = protocol::decode_server_message(*frame);
      if (!decoded) return std::nullopt;
      if (const auto* clients = std::get_if<protocol::Clients>(&*decoded.value)) return clients->clients.back().role;
    }
    return std::nullopt;
  }

  Server gallery_{options("gallery")}, other_{options("other")};
  std::unique_ptr<Room> room_;
};

TEST_F(RelayTest, passes_clients_on_with_the_role_that_their_token_here_has) {
  relay();
  for (const auto& [name, role] : {std::pair("host", protocol::Role::host), std::pair("guest", protocol::Role::actor),
                                   std::pair("viewer", protocol::Role::viewer)}) {
    PageClient client;
    EXPECT_EQ(join(client, name), role) << name;
  }
}

TEST_F(RelayTest, lets_in_nobody_without_a_token_of_its_own) {
  relay();
  for (const std::string token : {"", "other-host", "gallery"}) {
    PageClient client;
    EXPECT_EQ(client.connect(gallery_.port(), "/ws?token=" + token + "&world=chain"), 403u) << token;
  }
  PageClient foreign;
  EXPECT_EQ(foreign.connect(gallery_.port(), target("host"), {}, "http://elsewhere.example"), 403u);
  EXPECT_EQ(gallery_.visitors("chain"), 0);
}

TEST_F(RelayTest, lets_clients_wait_until_the_process_runs) {
  gallery_.relay("chain", 0, {});
  PageClient client;
  auto role = std::async(std::launch::async, [&] { return join(client, "host"); });
  while (gallery_.visitors("chain") == 0)
    EXPECT_EQ(role.wait_for(std::chrono::milliseconds(1)), std::future_status::timeout);
  relay();
  EXPECT_EQ(role.get(), protocol::Role::host);
  EXPECT_EQ(gallery_.visitors("chain"), 1);
}

TEST_F(RelayTest, lets_clients_go_when_their_world_is_no_longer_relayed_or_ends) {
  gallery_.relay("chain", 0, {});
  PageClient waiting;
  auto role = std::async(std::launch::async, [&] { return join(waiting, "host"); });
  while (gallery_.visitors("chain") == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  gallery_.end_relay("chain");
  EXPECT_EQ(role.get(), std::nullopt);
  relay();
  PageClient client;
  ASSERT_EQ(join(client, "host"), protocol::Role::host);
  room_.reset();
  while (client.receive()) {
  }
  EXPECT_TRUE(client.is_closed());
  for (int i = 0; i < 1000 && gallery_.visitors("chain") > 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_EQ(gallery_.visitors("chain"), 0);
}

}  // namespace
}  // namespace iota::net
