// SPDX-License-Identifier: Apache-2.0
// Shared by the clients of one world: its entities, settings and newest poses, the connected clients, and the two
// queues between the stepping thread and the server's thread. Knows messages, not sockets.
#pragma once

#include "net/entity_store.h"
#include "net/out_queue.h"
#include "net/pose_encoder.h"
#include "net/server.h"

#include <iota_protocol.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace iota::net {

/// The hub's interface of a client's connection.
class ClientLink {
 public:
  virtual void send(const Frame& frame, std::string_view key) = 0;
  /// There are newer entities or poses; fetch them when the socket has room.
  virtual void world_changed() = 0;
  /// Sends the reason and closes.
  virtual void drop(std::string_view reason) = 0;
  /// Sends the reason, after which a page does not come back by itself.
  virtual void refuse(std::string_view reason) { drop(reason); }
  /// The address of the machine, if it is another one.
  virtual std::string address() const { return {}; }
  /// The world has ended: sends the queue, then closes.
  virtual void world_ended() = 0;

 protected:
  ~ClientLink() = default;
};

/// Counts of a server, over all its worlds.
struct Counters {
  std::atomic<std::uint32_t> clients{0};
  std::atomic<std::uint64_t> bytes_sent{0}, frames_sent{0}, frames_dropped{0}, frames_refused{0}, upgrades_refused{0},
      clients_dropped{0};
};

class Hub {
 public:
  /// `call_frame`: schedules a call of frame() on the server's thread after a frame's time. Called there only.
  Hub(std::string world, std::size_t max_clients, Counters& counters, std::function<void()> call_frame);
  const std::string& world() const { return world_; }

  // --- from any thread. True: nothing was queued, so deliver() has to be called on the server's thread. Changes of
  // entities are collected, of poses only the newest counts; both reach clients together.
  [[nodiscard]] bool publish(const PoseSnapshot& snapshot, EntityChanges changes);
  /// A complete message: the latest of each type counts, and is sent to late joiners. client: to this one alone, until
  /// the next message of the type to all.
  template <class Message>
  [[nodiscard]] bool set(const Message& message, std::uint32_t client = 0);
  /// Kept: also sent to clients that join later, until it is removed or replaced by another one with the same id, or
  /// title without an id.
  [[nodiscard]] bool notice(std::uint32_t client, std::uint8_t level, std::string_view title, std::string_view text,
                            std::string_view hint, bool is_kept, const NoticeOptions& options = {});
  /// Removes the kept notices with this id or title, or all for an empty one.
  [[nodiscard]] bool forget_notice(std::string_view title);
  [[nodiscard]] bool ask_picture(std::uint32_t client, std::uint32_t number);
  [[nodiscard]] bool effect(std::string_view kind, const Vec3f& position, float volume = 1);
  [[nodiscard]] bool send_away(std::uint32_t client);
  [[nodiscard]] bool pulse(std::uint32_t client, const protocol::Pulse& pulse);
  std::vector<ClientInput> take_input();
  /// Only parts of pictures; everything else waits for take_input.
  std::vector<ClientInput> take_pictures();
  /// Returns when there is input, after `wake`, or after some seconds.
  void wait_for_input(double seconds);
  void wake();

  // --- on the server's thread
  /// Passes everything published to the clients: edits in order, then the newest poses.
  void deliver();
  /// Welcomes the client on `link` and replays the scene to it; returns its number, or 0 and the reason of a refusal.
  std::pair<std::uint32_t, std::string> join(ClientLink& link, const protocol::Hello& hello);
  void leave(std::uint32_t client);
  /// Sends `link` the messages to viewers, from the present state on. It is not a client and not shown to any.
  void watch(std::shared_ptr<ClientLink> link);
  void unwatch(const ClientLink& link);
  /// Sends messages that were delayed by a frame's time.
  void frame();
  /// Handles a frame of a welcomed client. Invalid frames are answered by a notice.
  void receive(std::uint32_t client, std::span<const std::uint8_t> bytes);
  void refuse_frame(std::uint32_t client, std::string_view reason);
  const PoseQuantizer& poses() const { return poses_; }
  /// Number of the newest poses, 0 before the first.
  std::uint64_t pose_number() const { return pose_number_; }
  EntityStore& entities() { return entities_; }
  /// Closes all connections.
  void end();

 private:
  using Clock = std::chrono::steady_clock;
  struct Client {
    ClientLink* link = nullptr;
    std::string name;
    protocol::Role role = protocol::Role::actor;
    protocol::Id selected;
    std::set<std::uint32_t> holds;
    bool is_told_to_wait = false;            ///< of too frequent resets
    std::uint32_t picture = 0;               ///< number of the requested one; 0: none
    std::size_t picture_bytes = 0;           ///< received bytes
    std::optional<protocol::Stance> stance;  ///< where its user is
  };
  using Edit = std::function<void()>;
  /// Queued input of one client.
  struct Waiting {
    std::size_t count = 0, bytes = 0;
  };

  bool post(Edit edit);
  void broadcast(const Frame& frame, std::string_view key = {});
  /// The present state, except entities and poses. client: its number, 0 for none.
  void greet(ClientLink& link, std::uint32_t client) const;
  protocol::Clients all_clients() const;
  /// Sends the list of clients with the next frame, as many may join, leave and select at once.
  void tell_clients();
  /// The same for the places of users.
  void tell_people();
  protocol::People all_people() const;
  [[nodiscard]] bool set_latest(std::string key, Frame frame, std::uint32_t client);
  void push_input(ClientInput input);
  /// Queues an input, or puts it in the place of an older one; false if too much waits.
  bool try_push(ClientInput input);
  void replace(ClientInput& older, ClientInput input);
  /// If the script has not even read that the client joined and much waits, it need not know of it.
  bool try_forget(std::uint32_t client);
  void tell(std::uint32_t client, const protocol::Notice& notice);
  /// Whether a client may send a message, by its role. A viewer is told that it can only watch, if the message says so.
  bool may_send(std::uint32_t client, protocol::Viewers viewers);
  /// Whether the world may be reset again; a client that wants it too often is told to wait.
  bool may_reset(std::uint32_t client);

  /// Checks what is the same for all messages and passes on those for the script.
  template <class Message>
  void handle(std::uint32_t client, Message message);
  /// Checks of a message of its own, and what the hub itself keeps of it; false: the script does not get it.
  template <class Message>
  bool accept(std::uint32_t, const Message&) {
    return true;
  }
  bool accept(std::uint32_t client, const protocol::Select& message);
  bool accept(std::uint32_t client, const protocol::GrabStart& message);
  bool accept(std::uint32_t client, const protocol::GrabMove& message);
  bool accept(std::uint32_t client, const protocol::GrabEnd& message);
  bool accept(std::uint32_t client, const protocol::Control& message);
  bool accept(std::uint32_t client, const protocol::Pointer& message);
  bool accept(std::uint32_t client, const protocol::Picture& message);
  bool accept(std::uint32_t client, const protocol::Presence& message);
  bool accept(std::uint32_t client, const protocol::Rename& message);
  /// Refuses the frame; false.
  bool refuse(std::uint32_t client, std::string_view reason);
  /// Messages that are for the server itself.
  void answer(std::uint32_t client, const protocol::Hello& message);
  void answer(std::uint32_t client, const protocol::Ping& message);
  void answer(std::uint32_t client, const protocol::SendAway& message);
  void send_away_now(std::uint32_t client);
  /// Whether a client is a host; others are told that this is for hosts.
  bool is_host(std::uint32_t client);

  const std::string world_;
  const std::size_t max_clients_;
  Counters& counters_;
  const std::function<void()> call_frame_;

  // Between the threads: to the server ...
  std::mutex out_mutex_;
  std::vector<Edit> edits_;
  PoseSnapshot snapshot_;
  std::vector<EntityChanges> changes_;
  std::uint64_t snapshot_number_ = 0;
  bool is_delivery_due_ = false;
  // ... and to the stepping thread.
  std::mutex in_mutex_;
  std::vector<ClientInput> input_;
  std::map<std::uint32_t, Waiting> waiting_;  ///< by client
  std::size_t waiting_bytes_ = 0;             ///< of all
  std::condition_variable has_input_;
  bool is_woken_ = false;

  // On the server's thread only.
  std::map<std::uint32_t, Client> clients_;
  std::vector<std::shared_ptr<ClientLink>> watchers_;
  std::set<std::string> sent_away_;  ///< addresses of machines
  std::uint32_t next_client_ = 1;
  double resets_left_ = 0;  ///< see may_reset
  Clock::time_point reset_at_ = Clock::time_point::min();
  std::vector<std::pair<std::string, Frame>> latest_;  ///< in the order in which keys were first set
  std::vector<std::pair<std::string, Frame>> kept_notices_;
  bool are_clients_told_ = true;
  bool are_people_told_ = true;
  EntityStore entities_;
  std::vector<Edit> delivering_;
  std::vector<EntityChanges> delivered_changes_;
  PoseSnapshot delivered_;
  PoseQuantizer poses_;
  std::uint64_t pose_number_ = 0;
};

template <class Message>
bool Hub::set(const Message& message, std::uint32_t client) {
  return set_latest(std::to_string(static_cast<int>(Message::message_type)),
                    std::make_shared<const std::vector<std::uint8_t>>(protocol::encode(message)), client);
}

}  // namespace iota::net
