// SPDX-License-Identifier: Apache-2.0
#include "net/relay.h"

#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/ostream.hpp>
#include <boost/beast/http.hpp>

#include <array>
#include <chrono>
#include <memory>
#include <sstream>
#include <utility>

namespace iota::net {
namespace {

namespace asio = boost::asio;
namespace http = boost::beast::http;
using asio::ip::tcp;
using error_code = boost::system::error_code;
using namespace std::chrono_literals;

constexpr auto look_time = 100ms;   // between two looks whether the process runs
constexpr auto start_time = 60s;    // for it to start
constexpr auto silence_time = 60s;  // the process itself ends clients that are silent for half of that

class Relay final : public std::enable_shared_from_this<Relay>, public OpenConnection {
 public:
  Relay(Stream stream, http::request<http::empty_body> request, std::string world, protocol::Role role,
        ConnectionContext& context)
      : context_(context),
        client_(std::move(stream)),
        request_(std::move(request)),
        world_(std::move(world)),
        role_(role),
        process_(client_.get_executor()),
        timer_(client_.get_executor()) {
    context_.opened(*this);
    context_.relays.count(world_, 1);
  }
  ~Relay() {
    context_.relays.count(world_, -1);
    context_.closed(*this);
  }
  Relay(const Relay&) = delete;
  Relay& operator=(const Relay&) = delete;

  void finish() override {
    error_code ignored;
    timer_.cancel();
    client_.close();
    process_.close(ignored);
  }
  void evict() override { finish(); }
  Standing standing() const override { return Standing::welcomed; }  // it knows the token

  void wait_for_process() {
    const auto target = context_.relays.find(world_);
    if (!target || context_.is_finishing || std::chrono::steady_clock::now() > end_) return finish();
    if (target->port != 0) return connect(*target);
    look_later();
  }

 private:
  void look_later() {
    timer_.expires_after(look_time);
    timer_.async_wait([self = shared_from_this()](error_code error) {
      if (!error) self->wait_for_process();
    });
  }

  /// One direction.
  template <class From, class To>
  void pass(From& from, To& to, std::array<char, 16384>& buffer) {
    from.async_read_some(asio::buffer(buffer), [self = shared_from_this(), &from, &to, &buffer](error_code error,
                                                                                                std::size_t size) {
      if (error) return self->finish();
      self->client_.expires_after(silence_time);
      asio::async_write(to, asio::buffer(buffer, size), [self, &from, &to, &buffer](error_code failed, std::size_t) {
        if (failed) return self->finish();
        self->pass(from, to, buffer);
      });
    });
  }

  void connect(const Relays::Target& target) {
    std::ostringstream out;
    request_.target("/ws?token=" + target.tokens[static_cast<std::size_t>(role_)]);
    request_.set(http::field::host, "127.0.0.1:" + std::to_string(target.port));
    request_.erase(http::field::origin);  // it was checked, and is not that of the process
    out << request_;
    head_ = out.str();
    process_.async_connect(
        {asio::ip::address_v4::loopback(), target.port}, [self = shared_from_this()](error_code error) {
          if (error) {  // it has just ended, and begins anew
            error_code ignored;
            self->process_.close(ignored);
            return self->look_later();
          }
          self->process_.set_option(tcp::no_delay(true), error);
          asio::async_write(self->process_, asio::buffer(self->head_), [self](error_code failed, std::size_t) {
            if (failed) return self->finish();
            self->pass(self->client_, self->process_, self->to_process_);
            self->pass(self->process_, self->client_, self->to_client_);
          });
        });
  }

  ConnectionContext& context_;
  Stream client_;
  http::request<http::empty_body> request_;
  const std::string world_;
  const protocol::Role role_;
  tcp::socket process_;
  asio::steady_timer timer_;
  const std::chrono::steady_clock::time_point end_ = std::chrono::steady_clock::now() + start_time;
  std::string head_;
  std::array<char, 16384> to_process_{}, to_client_{};
};

}  // namespace

void Relays::set(const std::string& world, Target target) {
  const std::lock_guard lock(mutex_);
  targets_[world] = std::move(target);
}

void Relays::remove(const std::string& world) {
  const std::lock_guard lock(mutex_);
  targets_.erase(world);
}

std::optional<Relays::Target> Relays::find(const std::string& world) const {
  const std::lock_guard lock(mutex_);
  const auto found = targets_.find(world);
  return found == targets_.end() ? std::nullopt : std::optional(found->second);
}

int Relays::visitors(const std::string& world) const {
  const std::lock_guard lock(mutex_);
  const auto found = visitors_.find(world);
  return found == visitors_.end() ? 0 : found->second;
}

void Relays::count(const std::string& world, int change) {
  const std::lock_guard lock(mutex_);
  visitors_[world] += change;
}

void start_relay(Stream stream, const http::request<http::empty_body>& request, const std::string& world,
                 protocol::Role role, ConnectionContext& context) {
  std::make_shared<Relay>(std::move(stream), request, world, role, context)->wait_for_process();
}

}  // namespace iota::net
