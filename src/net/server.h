// SPDX-License-Identifier: Apache-2.0
// The server of pages: static page and WebSocket on one port, on its own thread, for one world or several.
//
// Sees snapshots and input events only, never the live system. Lengths in m, times in s, forces in N.
#pragma once

#include "net/certificate.h"
#include "net/entity_store.h"

#include <iota/pose_snapshot.h>
#include <iota_protocol.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace iota::net {

using Vec3f = std::array<float, 3>;

struct ServerOptions {
  std::string host = "127.0.0.1";  ///< name or address to listen on
  /// With a certificate, other machines use https on the same port; plain http is for this machine only.
  Certificate certificate = {};
  std::uint16_t port = 8080;          ///< 0: any free one
  std::filesystem::path page_folder;  ///< the built page: index.html and its files
  std::string token;                  ///< of the host; every WebSocket needs this or another one; not empty
  /// The roles of clients with other tokens.
  std::vector<std::pair<std::string, protocol::Role>> other_tokens = {};
  std::size_t max_queue_bytes = 1 << 20;  ///< limit of queued notices and effects of one client
  std::size_t max_clients = 64;           ///< of each world
  double hello_time = 10;                 ///< s, from the upgrade of a connection to its first frame
  /// A listening socket, which the server takes over instead of listening itself; -1: none. It accepts from its first world
  /// on. Not on Windows.
  int listener = -1;
  /// The address under which a proxy serves this server's page, such as https://worlds.example.org; empty: none.
  std::string public_origin = {};
  /// The origin of a server that knows where this one's world is when it has moved: pages may ask it. Empty: none.
  std::string gateway = {};
  double answer_time = 5;  ///< s, in which the program has to answer a request
};

/// A request for one of the paths that the program answers.
struct Request {
  std::uint64_t number = 0;
  std::string path, query;             ///< the path without escapes, the query with them
  std::optional<protocol::Role> role;  ///< of its token; none only for an open path
  bool is_post = false;                ///< asks for a change
};

/// type: of the body, as a Content-Type. A body is empty or complete.
struct Answer {
  unsigned status = 200;
  std::string type, body;
};

/// How a card is shown. id: it replaces the card with the same one; empty: the one with its title. seconds: 0: as usual,
/// -1: until it is closed.
struct NoticeOptions {
  std::string id{};
  float seconds = 0;
  protocol::NoticePlace place = protocol::NoticePlace::free;
};

/// A message of a client that was welcomed, or an event of the server: the client joined or left.
struct ClientInput {
  std::uint32_t client = 0;  ///< from 1, never used twice in a world
  protocol::Input what;      ///< entities that it names may no longer exist
};

struct ServerStatistics {
  std::uint32_t clients = 0;     ///< welcomed and connected now
  std::uint64_t bytes_sent = 0;  ///< payload of WebSocket frames
  std::uint64_t frames_sent = 0;
  std::uint64_t frames_dropped = 0;    ///< poses that were not sent to a slow client
  std::uint64_t frames_refused = 0;    ///< frames that could not be decoded
  std::uint64_t upgrades_refused = 0;  ///< wrong Host, Origin or token
  std::uint64_t clients_dropped = 0;   ///< for a full queue, or silence
};

class Hub;
class Recorder;

/// A message that viewers were sent. time: s, from the start of the recording.
struct RecordedMessage {
  double time = 0;
  std::vector<std::uint8_t> bytes;
};

/// Keeps what the viewers of a world are sent, from the state at its start on, until it is destroyed. What is for one
/// client is not in it.
class Recording {
 public:
  ~Recording();
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;

  /// The messages since the last call, from any thread. If they are not taken for long, poses are left out.
  std::vector<RecordedMessage> take();

 private:
  friend class Room;
  Recording(std::shared_ptr<Recorder> recorder, std::function<void()> end);

  std::shared_ptr<Recorder> recorder_;
  std::function<void()> end_;
};

/// One world on a server. All members may be called from any thread; none waits for a client. Calls after the end of
/// the server have no effect.
class Room {
 public:
  /// Tells its clients that the world has ended.
  ~Room();
  Room(const Room&) = delete;
  Room& operator=(const Room&) = delete;

  const std::string& world() const;

  /// The newest state, and changes of entities since the last call. Each client gets the newest poses as soon as its
  /// socket has room, so slow ones skip some. A body at a place that is not finite keeps its last pose on the page.
  void publish(const PoseSnapshot& snapshot, EntityChanges changes = {});
  /// For present and later clients. Throw std::length_error above the protocol's limits and std::invalid_argument for
  /// text that is not UTF-8. client: for this one alone, until the next settings for all (client 0).
  void set(const protocol::WorldSettings& settings, std::uint32_t client = 0);
  void set(const protocol::WorldState& state);
  void set(const protocol::Actions& actions);
  void set(const protocol::Listens& listens);
  /// Asks one client for a picture; its parts arrive as input with this number. One at a time.
  void ask_picture(std::uint32_t client, std::uint32_t number);
  /// A card on one client's page, or on all (client 0). Level 0 info, 1 warning, 2 error. Long texts are cut. Kept ones
  /// are shown to later clients too, at most eight, until `forget_notice` with their id or title, or an empty one for all.
  void notice(std::uint32_t client, std::uint8_t level, std::string_view title, std::string_view text,
              std::string_view hint = {}, bool is_kept = false, const NoticeOptions& options = {});
  void forget_notice(std::string_view title);
  /// Flash, sound and haptic pulse: "break", "join" or "grab" at a place in the world. Throws std::invalid_argument
  /// for a place that is not finite, std::length_error for a kind above 32 bytes.
  void effect(std::string_view kind, const Vec3f& position, float volume = 1);
  /// A haptic pulse in the hands of one user. Throws std::invalid_argument for numbers that are not finite,
  /// std::length_error for a hand above 32 bytes.
  void pulse(std::uint32_t client, const protocol::Pulse& pulse);

  /// Records what viewers are sent. pose_time: between two recorded poses, s.
  std::unique_ptr<Recording> record(double pose_time);

  /// Ends the connection of a client; one on another machine stays away, if it is not a host.
  void send_away(std::uint32_t client);

  /// Inputs since the last call, in order of arrival. Of successive moves of one grip or pointer there is only the
  /// newest. A `Leave` ends the client's holds and selection: no `GrabEnd` precedes it.
  std::vector<ClientInput> take_input();
  /// Only parts of pictures, while the script waits for one; everything else waits for `take_input`.
  std::vector<ClientInput> take_pictures();
  /// Returns when there is input, after `wake`, or after some seconds: for a loop that has nothing else to do.
  void wait_for_input(double seconds);
  /// From any thread.
  void wake();

 private:
  friend class Server;
  struct Link;  ///< to the server's thread, while it exists
  Room(std::shared_ptr<Hub> hub, std::shared_ptr<Link> link);
  void deliver_if(bool is_due);

  std::shared_ptr<Hub> hub_;
  std::shared_ptr<Link> link_;
};

class Server {
 public:
  /// Listens when it returns. Throws std::system_error if it cannot (port in use, host unknown) and
  /// std::invalid_argument for an empty token.
  explicit Server(ServerOptions options);
  /// Sends queued frames, for at most a quarter of a second, and closes all connections.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// A world that clients choose by its id, from any thread. A client without an id gets the first one.
  /// Throws std::invalid_argument for an id that is empty, above 128 bytes, not UTF-8, or in use.
  std::unique_ptr<Room> open(const std::string& world);

  std::uint16_t port() const;
  std::string url() const;                          ///< http://127.0.0.1:8080/?token=...
  std::string url(const std::string& world) const;  ///< the same with &world=...
  /// Address for other machines; `host` is this one: https://192.168.0.2:8080/?token=... An empty world: the first.
  std::string url_at(const std::string& host, const std::string& world = {}) const;
  ServerStatistics statistics() const;

  /// A world that another process serves, as its only one: clients that name it in the address of their WebSocket are
  /// passed on to its port on the loopback address, with its token for their role. Port 0: they wait until it is known.
  void relay(const std::string& world, std::uint16_t port, const std::array<std::string, 3>& tokens);
  /// Clients that wait for it are let go.
  void end_relay(const std::string& world);
  /// Clients that are passed on to it, or wait.
  int visitors(const std::string& world) const;

  /// Requests for these paths wait for the program, if their token is right. A POST comes from the server's own page and
  /// has no body. is_open: with any token and from pages of any origin; the program decides.
  void serve_requests(std::vector<std::string> paths, bool is_open = false);
  /// The requests since the last call. Each has to be answered within `ServerOptions::answer_time`.
  std::vector<Request> take_requests();
  void answer(std::uint64_t number, Answer answer);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace iota::net
