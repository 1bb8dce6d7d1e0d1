// SPDX-License-Identifier: Apache-2.0
// The server that a page talks to: static page and WebSocket on one port, on its own thread.
//
// Sees snapshots and input events only, never the live system. Lengths in m, times in s, forces in N.
#pragma once

#include <iota/pose_snapshot.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace iota::net {

using Vec3f = std::array<float, 3>;

/// In place of a body's slot: none.
inline constexpr std::uint32_t no_body = 0xFFFFFFFF;

struct ServerOptions {
  std::string host = "127.0.0.1";         ///< name or address to listen on
  std::uint16_t port = 8080;              ///< 0: any free one
  std::filesystem::path page_folder;      ///< the built page: index.html and what it loads
  std::string token;                      ///< asked of every WebSocket; must not be empty
  std::string world = "default";          ///< world id, at most 128 bytes
  double dt = 1.0 / 120;                  ///< length of a step
  std::size_t max_queue_bytes = 1 << 20;  ///< notices and effects that may wait for one client
  std::size_t max_clients = 64;
  double hello_time = 10;  ///< s, from the upgrade of a connection to its first frame
};

/// What a user did, or that one came or went. Fields that a kind does not need are left at their defaults.
struct InputEvent {
  enum class Kind : std::uint8_t { join, leave, select, grab_start, grab_move, grab_end, action, control };
  Kind kind = Kind::join;
  std::uint32_t client = 0;      ///< from 1, never used twice
  std::uint32_t hold = 0;        ///< grab_...: the client's own number for this hand
  std::uint32_t body = no_body;  ///< slot, not checked against the system
  Vec3f local_point{};           ///< grab_start: body frame
  Vec3f target{};                ///< grab_start, grab_move: world frame
  std::string name;              ///< join: the client's name; action: the action's name
  std::uint8_t command = 0;      ///< control: 0 pause, 1 play, 2 single step, 3 reset, 4 speed
  float value = 0;               ///< control: speed in times real time
};

struct ServerStatistics {
  std::uint32_t clients = 0;     ///< welcomed and connected now
  std::uint64_t bytes_sent = 0;  ///< payload of WebSocket frames
  std::uint64_t frames_sent = 0;
  std::uint64_t frames_dropped = 0;    ///< poses that a slow client never got, as a newer one was there
  std::uint64_t frames_refused = 0;    ///< frames from clients that were not understood
  std::uint64_t upgrades_refused = 0;  ///< wrong Host, Origin or token
  std::uint64_t clients_dropped = 0;   ///< over their queue, or silent
};

/// All members may be called from any thread. None waits for a client.
class Server {
 public:
  /// Listens when it returns. Throws std::system_error when it cannot (port taken, host unknown) and
  /// std::invalid_argument for an empty token or a world id that does not fit.
  explicit Server(ServerOptions options);
  /// Lets what is queued leave, for a quarter of a second at most, and closes all connections.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  std::uint16_t port() const;
  std::string url() const;  ///< http://127.0.0.1:8080/?token=...

  /// The newest state; each client gets the newest one as soon as it can take it, so slow ones skip some.
  /// A body that is not at a finite place keeps its last pose on the page.
  void publish(const PoseSnapshot& snapshot);
  /// Which articulate each body belongs to, whole. Throws std::length_error above 1 048 576 bodies.
  void publish_structure(std::uint32_t structure_version, std::span<const BodyArticulate> articulates);
  /// Sets one keyed part of the scene for present and later clients; "null" removes it. `json` is not parsed.
  /// Throws std::length_error for a key above 64 bytes or a text above 16 MiB, std::invalid_argument if not UTF-8.
  void set_scene(std::string_view key, std::string_view json);
  /// A card on one client's page, or on all (client 0). Level 0 info, 1 warning, 2 error. Too long a text is cut.
  void notice(std::uint32_t client, std::uint8_t level, std::string_view title, std::string_view text,
              std::string_view hint = {});
  /// Flash, sound and haptic pulse: "break", "join" or "grab" at a place in the world. Throws std::invalid_argument
  /// for a place that is not finite, std::length_error for a kind above 32 bytes.
  void effect(std::string_view kind, const Vec3f& position);

  /// What happened since the last call, in order of arrival. Moves of one hand that follow each other come as one.
  /// A `leave` ends the client's holds and selection: no grab_end precedes it.
  std::vector<InputEvent> take_input();

  ServerStatistics statistics() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace iota::net
