// SPDX-License-Identifier: Apache-2.0
#include "net/server.h"

#include "net/connection.h"
#include "net/hub.h"
#include "net/recorder.h"
#include "net/relay.h"
#include "net/requests.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <exception>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>

#ifndef _WIN32
#include <sys/socket.h>

#include <cerrno>
#endif

namespace iota::net {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using error_code = boost::system::error_code;
using namespace std::chrono_literals;

constexpr auto farewell_time = 250ms;
constexpr auto accept_pause = 100ms;
constexpr auto accept_look = 2ms;
constexpr auto frame_time = 16ms;

[[noreturn]] void fail(const error_code& error, const std::string& what) { throw std::system_error(error, what); }

std::string address_of(const ServerOptions& options) { return options.host + " port " + std::to_string(options.port); }

ServerOptions checked(ServerOptions options) {
  if (options.token.empty()) throw std::invalid_argument("the server needs a token");
  for (std::string* const origin : {&options.public_origin, &options.gateway})
    if (!origin->empty()) *origin = checked_origin(*origin);
  return options;
}

void check_world(const std::string& world) {
  if (world.empty()) throw std::invalid_argument("a world needs an id");
  try {
    protocol::encode(protocol::Welcome{protocol::protocol_version, world, 1});
  } catch (const std::length_error& error) {
    throw std::invalid_argument(error.what());
  }
}

std::string percent_encoded(const std::string& text) {
  std::string out;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) || c == '-' || c == '_' || c == '.' || c == '~') {
      out += c;
    } else {
      constexpr const char* digits = "0123456789ABCDEF";
      out.append({'%', digits[byte >> 4], digits[byte & 15]});
    }
  }
  return out;
}

std::string address(const std::string& scheme, const std::string& host, std::uint16_t port, const std::string& token) {
  const bool is_v6 = host.find(':') != std::string::npos;
  return scheme + "://" + (is_v6 ? "[" + host + "]" : host) + ":" + std::to_string(port) + "/?token=" + token;
}

std::string in_query(const std::string& world) { return "&world=" + percent_encoded(world); }

error_code try_listen(tcp::acceptor& acceptor, const tcp::endpoint& endpoint) {
  error_code error;
  acceptor.open(endpoint.protocol(), error);
  if (error) return error;
#ifndef _WIN32
  // Otherwise a restart would have to wait until old connections have timed out. (On Windows the option would
  // allow two servers on one port.)
  acceptor.set_option(asio::socket_base::reuse_address(true), error);
#endif
  acceptor.bind(endpoint, error);
  if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
  return error;
}

/// Takes over a socket that listens already.
tcp::acceptor take_over(asio::io_context& io, int listener) {
  error_code error;
  tcp::acceptor acceptor(io);
#ifdef _WIN32
  error = asio::error::operation_not_supported;
#else
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  if (::getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size) != 0)
    error = error_code(errno, boost::system::system_category());
  else
    acceptor.assign(address.ss_family == AF_INET6 ? tcp::v6() : tcp::v4(), listener, error);
#endif
  if (error) fail(error, "the socket " + std::to_string(listener) + " cannot be taken over");
  return acceptor;
}

/// A listening socket, on the first possible address of the host. Throws std::system_error.
tcp::acceptor listen(asio::io_context& io, const ServerOptions& options) {
  if (options.listener >= 0) return take_over(io, options.listener);
  error_code error;
  tcp::resolver resolver(io);
  const auto found = resolver.resolve(options.host, std::to_string(options.port), tcp::resolver::passive, error);
  if (error) fail(error, "cannot find the address of host '" + options.host + "'");
  for (const auto& entry : found) {
    tcp::acceptor acceptor(io);
    error = try_listen(acceptor, entry.endpoint());
    if (!error) return acceptor;
    if (error == asio::error::address_in_use) break;  // do not try another address, which the user would not expect
  }
  if (error == asio::error::address_in_use) fail(error, address_of(options) + " is taken, choose another port");
  fail(error, "cannot listen on " + address_of(options));
}

}  // namespace

/// The worlds of a server, in the order in which they were opened. From any thread.
class Worlds {
 public:
  std::shared_ptr<Hub> open(const std::string& world, std::size_t max_clients, Counters& counters,
                            std::function<void()> call_frame) {
    const std::lock_guard lock(mutex_);
    if (find(world) != hubs_.end())
      throw std::invalid_argument("there is a world '" + world + "' on this server already");
    return hubs_.emplace_back(std::make_shared<Hub>(world, max_clients, counters, std::move(call_frame)));
  }
  std::vector<std::shared_ptr<Hub>> all() {
    const std::lock_guard lock(mutex_);
    return hubs_;
  }
  void close(const std::shared_ptr<Hub>& hub) {
    const std::lock_guard lock(mutex_);
    std::erase(hubs_, hub);
  }
  /// The hub for a hello, or none and the reason.
  std::pair<std::shared_ptr<Hub>, std::string> ask(const std::string& world) {
    const std::lock_guard lock(mutex_);
    if (hubs_.empty()) return {nullptr, "there is no world here yet"};
    if (world.empty()) return {hubs_.front(), {}};
    if (const auto found = find(world); found != hubs_.end()) return {*found, {}};
    constexpr std::size_t most = 5;  // a reason has 1024 bytes
    std::string reason = "there is no world '" + world + "' here; there are: " + hubs_.front()->world();
    for (std::size_t i = 1; i < std::min(most, hubs_.size()); ++i) reason += ", " + hubs_[i]->world();
    if (hubs_.size() > most) reason += ", ...";
    return {nullptr, reason};
  }

 private:
  std::vector<std::shared_ptr<Hub>>::iterator find(const std::string& world) {
    return std::ranges::find_if(hubs_, [&](const auto& hub) { return hub->world() == world; });
  }
  std::mutex mutex_;
  std::vector<std::shared_ptr<Hub>> hubs_;
};

struct Room::Link {
  explicit Link(asio::io_context& context) : io(&context) {}
  /// Runs something on the server's thread.
  template <class Work>
  void post(Work work) {
    const std::lock_guard lock(mutex);
    if (io) asio::post(*io, std::move(work));
  }
  void cut() {
    const std::lock_guard lock(mutex);
    io = nullptr;
  }

  std::mutex mutex;
  asio::io_context* io;
  Worlds worlds;
};

struct Server::Implementation {
  explicit Implementation(ServerOptions given)
      : options(checked(std::move(given))),
        link(std::make_shared<Room::Link>(io)),
        tls(make_tls(options.certificate)),
        context{options, counters, tls.get(), [this](const std::string& world) { return link->worlds.ask(world); },
                relays,  requests},
        acceptor(listen(io, options)),
        timer(io),
        frame_timer(io) {
    context.port = acceptor.local_endpoint().port();
    context.on_all_closed = [this] { io.stop(); };
    options.listener < 0 ? accept() : accept_once_open();
    thread = std::thread([this] { run(); });
  }

  ~Implementation() {
    link->cut();
    asio::post(io, [this] { finish(); });
    thread.join();
    context.on_all_closed = nullptr;  // remaining connections are destroyed with io
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  void run() {
    for (;;) {
      try {
        io.run();
        return;
      } catch (const std::exception&) {
        // Out of memory in one client's handler: that client is lost, the others continue.
      }
    }
  }

  /// Who waits in the queue of a socket that was taken over finds a world: without one, it would be refused.
  void accept_once_open() {
    if (!link->worlds.all().empty()) return accept();
    timer.expires_after(accept_look);
    timer.async_wait([this](error_code) {
      if (!context.is_finishing) accept_once_open();
    });
  }

  void accept() {
    acceptor.async_accept([this](error_code error, tcp::socket socket) {
      if (context.is_finishing) return;
      if (!error) {
        start_connection(std::move(socket), context);
        return accept();
      }
      // Usually there is no file descriptor left, so it waits before trying again.
      timer.expires_after(accept_pause);
      timer.async_wait([this](error_code) {
        if (!context.is_finishing) accept();
      });
    });
  }

  /// Calls frame() of all hubs after a frame's time.
  void call_frame() {
    if (std::exchange(is_frame_due, true)) return;
    frame_timer.expires_after(frame_time);
    frame_timer.async_wait([this](error_code error) {
      is_frame_due = false;
      if (error) return;
      for (const auto& hub : link->worlds.all()) hub->frame();
    });
  }

  void finish() {
    context.is_finishing = true;
    error_code ignored;
    acceptor.close(ignored);
    timer.expires_after(farewell_time);
    timer.async_wait([this](error_code) { io.stop(); });
    const auto open = context.open;  // closing may remove some
    for (OpenConnection* connection : open) {
      if (context.is_open(connection)) connection->finish();
    }
    if (context.open.empty()) io.stop();
  }

  const ServerOptions options;
  Counters counters;
  std::shared_ptr<Room::Link> link;
  Relays relays;
  Requests requests;
  const std::unique_ptr<asio::ssl::context> tls;
  ConnectionContext context;
  asio::io_context io{1};  // destroyed first: handlers own connections, which refer to the members above
  tcp::acceptor acceptor;
  asio::steady_timer timer, frame_timer;
  bool is_frame_due = false;
  std::thread thread;
};

Server::Server(ServerOptions options) : implementation_(std::make_unique<Implementation>(std::move(options))) {}
Server::~Server() = default;

std::uint16_t Server::port() const { return implementation_->context.port; }

std::string Server::url() const {
  const std::string& host = implementation_->options.host;
  const bool is_any = host == "0.0.0.0" || host == "::" || host.empty();
  return address("http", is_any ? "127.0.0.1" : host, port(), implementation_->options.token);
}

std::string Server::url(const std::string& world) const { return url() + in_query(world); }

std::string Server::url_at(const std::string& host, const std::string& world) const {
  const char* scheme = implementation_->options.certificate.chain.empty() ? "http" : "https";
  return address(scheme, host, port(), implementation_->options.token) + (world.empty() ? "" : in_query(world));
}

std::unique_ptr<Room> Server::open(const std::string& world) {
  check_world(world);
  const auto& link = implementation_->link;
  auto hub = link->worlds.open(world, implementation_->options.max_clients, implementation_->counters,
                               [server = implementation_.get()] { server->call_frame(); });
  return std::unique_ptr<Room>(new Room(std::move(hub), link));
}

ServerStatistics Server::statistics() const {
  const Counters& now = implementation_->counters;
  return {now.clients,        now.bytes_sent,       now.frames_sent,    now.frames_dropped,
          now.frames_refused, now.upgrades_refused, now.clients_dropped};
}

void Server::relay(const std::string& world, std::uint16_t port, const std::array<std::string, 3>& tokens) {
  implementation_->relays.set(world, {port, tokens});
}
void Server::end_relay(const std::string& world) { implementation_->relays.remove(world); }
int Server::visitors(const std::string& world) const { return implementation_->relays.visitors(world); }

void Server::serve_requests(std::vector<std::string> paths, bool is_open) {
  implementation_->requests.serve(std::move(paths), is_open);
}
std::vector<Request> Server::take_requests() { return implementation_->requests.take(); }
void Server::answer(std::uint64_t number, Answer answer) {
  asio::post(implementation_->io, [&requests = implementation_->requests, number, answer = std::move(answer)] {
    requests.answer(number, answer);
  });
}

// ------------------------------------------------------------------------------------------------------------ a room

Room::Room(std::shared_ptr<Hub> hub, std::shared_ptr<Link> link) : hub_(std::move(hub)), link_(std::move(link)) {}

Room::~Room() {
  link_->worlds.close(hub_);
  link_->post([hub = hub_] {
    hub->deliver();
    hub->end();
  });
}

void Room::deliver_if(bool is_due) {
  if (is_due) link_->post([hub = hub_] { hub->deliver(); });
}

const std::string& Room::world() const { return hub_->world(); }

void Room::publish(const PoseSnapshot& snapshot, EntityChanges changes) {
  deliver_if(hub_->publish(snapshot, std::move(changes)));
}

void Room::set(const protocol::WorldSettings& settings, std::uint32_t client) {
  deliver_if(hub_->set(settings, client));
}
void Room::set(const protocol::WorldState& state) { deliver_if(hub_->set(state)); }
void Room::set(const protocol::Actions& actions) { deliver_if(hub_->set(actions)); }
void Room::set(const protocol::Listens& listens) { deliver_if(hub_->set(listens)); }
void Room::ask_picture(std::uint32_t client, std::uint32_t number) { deliver_if(hub_->ask_picture(client, number)); }

void Room::notice(std::uint32_t client, std::uint8_t level, std::string_view title, std::string_view text,
                  std::string_view hint, bool is_kept, const NoticeOptions& options) {
  deliver_if(hub_->notice(client, level, title, text, hint, is_kept, options));
}

void Room::forget_notice(std::string_view title) { deliver_if(hub_->forget_notice(title)); }

void Room::effect(std::string_view kind, const Vec3f& position, float volume) {
  deliver_if(hub_->effect(kind, position, volume));
}

void Room::pulse(std::uint32_t client, const protocol::Pulse& pulse) { deliver_if(hub_->pulse(client, pulse)); }

std::unique_ptr<Recording> Room::record(double pose_time) {
  auto recorder = std::make_shared<Recorder>(*hub_, std::chrono::duration<double>(pose_time));
  link_->post([hub = hub_, recorder] { hub->watch(recorder); });
  auto end = [hub = hub_, link = link_, recorder = recorder.get()] {
    link->post([hub, recorder] { hub->unwatch(*recorder); });
  };
  return std::unique_ptr<Recording>(new Recording(std::move(recorder), std::move(end)));
}

void Room::send_away(std::uint32_t client) { deliver_if(hub_->send_away(client)); }

std::vector<ClientInput> Room::take_input() { return hub_->take_input(); }
void Room::wait_for_input(double seconds) { hub_->wait_for_input(seconds); }
void Room::wake() { hub_->wake(); }
std::vector<ClientInput> Room::take_pictures() { return hub_->take_pictures(); }

Recording::Recording(std::shared_ptr<Recorder> recorder, std::function<void()> end)
    : recorder_(std::move(recorder)), end_(std::move(end)) {}

Recording::~Recording() { end_(); }

std::vector<RecordedMessage> Recording::take() { return recorder_->take(); }

}  // namespace iota::net
