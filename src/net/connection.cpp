// SPDX-License-Identifier: Apache-2.0
#include "net/connection.h"

#include "net/relay.h"
#include "net/requests.h"
#include "net/static_files.h"
#include "net/stream.h"
#include "net/token.h"
#include "net/updates.h"

#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/core/detect_ssl.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#ifdef __linux__
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#endif

namespace iota::net {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using error_code = boost::system::error_code;
using namespace std::chrono_literals;

constexpr auto header_time = 5s;    // for a request, on a new connection or after an answer
constexpr auto answer_time = 20s;   // for the client to receive an answer
constexpr auto silence_time = 30s;  // without even an answer to a ping
constexpr auto close_time = 1s;     // for the client's part of a close
constexpr const char* wrong_token = "the token is wrong: open the URL that the server printed";
constexpr std::size_t max_connections = 512;
constexpr std::size_t max_strangers = 128;  // of connections that are not welcomed; a client with the token needs few

/// The page loads only its own files and runs no inline code; three.js makes textures and workers from blobs. It uses
/// only the WebSocket of this server, which 'self' does not include in every browser. Pages of others may frame it
/// where they know the token (a notebook): who does not could only lay it invisibly under a click. The page asks the
/// gateway where a world is that has moved.
std::string content_security_policy(Scheme scheme, std::string_view host, bool may_be_framed,
                                    const std::string& gateway) {
  const auto is_plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || std::strchr(".-:[]", c);
  };
  std::string socket;  // empty for a request with a refused Host
  if (!host.empty() && std::ranges::all_of(host, is_plain))
    socket = std::string(scheme == Scheme::https ? " wss://" : " ws://").append(host);
  if (!gateway.empty()) socket += " " + gateway;
  return "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self' blob:; connect-src 'self'" +
         socket +
         " blob: data:; img-src 'self' blob: data:; media-src 'self' blob: data:; object-src 'none'; base-uri 'none'; "
         "form-action 'none'" +
         (may_be_framed ? "" : "; frame-ancestors 'self'");
}

std::string_view to_view(beast::string_view text) { return {text.data(), text.size()}; }

// -------------------------------------------------------------------------------------------------------- WebSocket

class WebSocketSession final : public std::enable_shared_from_this<WebSocketSession>,
                               public ClientLink,
                               public OpenConnection {
 public:
  WebSocketSession(Stream stream, ConnectionContext& context, protocol::Role role)
      : context_(context),
        role_(role),
        socket_(std::move(stream)),
        timer_(socket_.get_executor()),
        queue_(context.options.max_queue_bytes) {
    context_.opened(*this);
  }
  ~WebSocketSession() { context_.closed(*this); }
  WebSocketSession(const WebSocketSession&) = delete;
  WebSocketSession& operator=(const WebSocketSession&) = delete;

  void start(const http::request<http::empty_body>& request) {
    websocket::stream_base::timeout timeout{};
    timeout.handshake_timeout = header_time;
    timeout.idle_timeout = silence_time;
    timeout.keep_alive_pings = true;
    socket_.set_option(timeout);
    socket_.read_message_max(protocol::max_client_frame_bytes);
    socket_.auto_fragment(false);
    socket_.binary(true);
    // permessage-deflate is off, Beast's default: it hardly compresses poses, and costs time and memory.
    keep_send_buffer_short();
    socket_.async_accept(request, [self = shared_from_this()](error_code error) {
      if (error) return;
      self->is_open_ = true;
      self->wait_for_hello();
      self->read();
    });
  }

  // Called by the hub, possibly in its loop over all clients: it must not call back.
  void send(const Frame& frame, std::string_view key) override {
    if (is_closing_) return;
    if (!queue_.push(frame, key)) return drop("too slow: too much is waiting for this client");
    pump();
  }
  void world_changed() override { pump(); }
  void drop(std::string_view reason) override {
    if (is_closing_) return;
    ++context_.counters.clients_dropped;
    queue_.clear();
    close_when_sent(websocket::close_code::policy_error, reason);
    start_close();
  }

  void refuse(std::string_view reason) override {
    send_refusal(reason, static_cast<websocket::close_code>(protocol::sent_away_close_code));
  }
  std::string address() const override {
    error_code error;
    const auto other = socket_.next_layer().socket().remote_endpoint(error);
    return error || other.address().is_loopback() ? std::string() : other.address().to_string();
  }
  void world_ended() override { close_when_sent(websocket::close_code::going_away, "the world has ended"); }
  void finish() override { close_when_sent(websocket::close_code::going_away, "the server stops"); }
  void evict() override { ended(); }
  Standing standing() const override { return client_ == 0 ? Standing::idle : Standing::welcomed; }

 private:
  /// A slow client should skip poses, not receive them late from a long buffer in the kernel.
  void keep_send_buffer_short() {
    error_code ignored;
    auto& socket = socket_.next_layer().socket();
    socket.set_option(asio::socket_base::send_buffer_size(256 * 1024), ignored);
#if defined(__linux__) && defined(TCP_NOTSENT_LOWAT)
    const int bytes = 16 * 1024;
    ::setsockopt(socket.native_handle(), IPPROTO_TCP, TCP_NOTSENT_LOWAT, &bytes, sizeof bytes);
#endif
  }

  void wait_for_hello() {
    timer_.expires_after(std::chrono::duration_cast<std::chrono::milliseconds>(
        std::chrono::duration<double>(context_.options.hello_time)));
    timer_.async_wait([weak = weak_from_this()](error_code error) {
      const auto self = weak.lock();
      if (!error && self && self->client_ == 0) self->send_refusal("no hello came");
    });
  }

  void read() {
    socket_.async_read(buffer_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error) return self->ended();
      if (!self->is_closing_) self->take_frame();
      self->buffer_.consume(self->buffer_.size());
      self->read();
    });
  }

  void take_frame() {
    const auto data = buffer_.cdata();
    const std::span bytes(static_cast<const std::uint8_t*>(data.data()), data.size());
    if (client_ == 0) return take_hello(bytes);
    if (socket_.got_text()) return hub_->refuse_frame(client_, "the frame is text, not binary");
    hub_->receive(client_, bytes);
  }

  void take_hello(std::span<const std::uint8_t> bytes) {
    const auto decoded = protocol::decode_client_message(bytes);
    const auto* hello = decoded ? std::get_if<protocol::Hello>(&*decoded.value) : nullptr;
    if (hello == nullptr) {
      ++context_.counters.frames_refused;
      return send_refusal(decoded ? "the first frame has to be hello"
                                  : "the first frame has to be hello: " + decoded.error);
    }
    auto [hub, unknown] = context_.find_world(hello->world);
    if (!hub) return send_refusal(unknown);
    protocol::Hello granted = *hello;  // the address says what a client may do; one can only ask for less
    if (granted.role != protocol::Role::viewer) granted.role = role_;
    auto [client, reason] = hub->join(*this, granted);
    if (client == 0) return send_refusal(reason);
    hub_ = std::move(hub);
    client_ = client;
    timer_.cancel();
    pump();
  }

  void send_refusal(std::string_view reason, websocket::close_code code = websocket::close_code::policy_error) {
    if (is_closing_) return;
    // The reason may contain a name from outside, which is known to be UTF-8 and short.
    protocol::Refused message{std::string(reason.substr(0, 1024))};
    send(std::make_shared<const std::vector<std::uint8_t>>(protocol::encode(message)), {});
    close_when_sent(code, "refused");
  }

  /// Sends as much as fits: messages first, then entities, then poses.
  void pump() {
    if (!is_open_ || is_writing_ || is_close_started_) return;
    if (!queue_.empty()) {
      outgoing_ = queue_.pop();
      return write(asio::buffer(*outgoing_));
    }
    if (is_closing_) return start_close();
    if (client_ == 0) return;
    const auto bytes = updates_.next(*hub_);
    context_.counters.frames_dropped += updates_.take_skipped();
    if (bytes) write(asio::buffer(bytes->data(), bytes->size()));
  }

  void write(asio::const_buffer bytes) {
    is_writing_ = true;
    socket_.async_write(bytes, [self = shared_from_this()](error_code error, std::size_t size) {
      self->is_writing_ = false;
      if (error) return self->ended();
      self->context_.counters.bytes_sent += size;
      ++self->context_.counters.frames_sent;
      self->pump();
    });
  }

  void close_when_sent(websocket::close_code code, std::string_view reason) {
    if (is_closing_) return;
    is_closing_ = true;
    // The protocol limits a reason to 123 bytes.
    close_reason_ = websocket::close_reason(code, beast::string_view(reason.substr(0, 123)));
    timer_.expires_after(close_time);
    timer_.async_wait([weak = weak_from_this()](error_code error) {
      const auto self = weak.lock();
      if (!error && self) self->ended();
    });
    pump();
  }

  void start_close() {
    if (!is_open_ || std::exchange(is_close_started_, true)) return;
    socket_.async_close(close_reason_, [self = shared_from_this()](error_code) { self->ended(); });
  }

  /// Called from handlers only, so never in the hub's loop over its clients.
  void ended() {
    is_closing_ = true;
    is_close_started_ = true;
    timer_.cancel();
    queue_.clear();
    if (const std::uint32_t client = std::exchange(client_, 0); client != 0) hub_->leave(client);
    socket_.next_layer().close();
  }

  ConnectionContext& context_;
  const protocol::Role role_;
  std::shared_ptr<Hub> hub_;  ///< none until welcomed
  websocket::stream<Stream> socket_;
  asio::steady_timer timer_;
  beast::flat_buffer buffer_;
  OutQueue queue_;
  Updates updates_;
  Frame outgoing_;
  std::uint32_t client_ = 0;  ///< 0 until welcomed
  websocket::close_reason close_reason_;
  bool is_open_ = false, is_writing_ = false, is_closing_ = false, is_close_started_ = false;
};

// ------------------------------------------------------------------------------------------------------------- HTTP

class HttpSession final : public std::enable_shared_from_this<HttpSession>, public OpenConnection {
 public:
  HttpSession(tcp::socket socket, ConnectionContext& context)
      : context_(context), stream_(std::move(socket)), timer_(stream_.get_executor()) {
    context_.opened(*this);
  }
  ~HttpSession() { context_.closed(*this); }
  HttpSession(const HttpSession&) = delete;
  HttpSession& operator=(const HttpSession&) = delete;

  /// With a certificate, the first byte shows whether this is https.
  void start() {
    if (context_.tls == nullptr) return read();
    stream_.expires_after(header_time);
    beast::async_detect_ssl(stream_, buffer_, [self = shared_from_this()](error_code error, bool is_tls) {
      if (error) return self->finish();
      if (is_tls) return self->encrypt();
      self->must_redirect_ = !self->is_from_here();
      self->read();
    });
  }

  void finish() override {
    timer_.cancel();
    stream_.close();
  }
  void evict() override { finish(); }
  Standing standing() const override { return is_served_ ? Standing::served : Standing::idle; }

 private:
  using Request = http::request<http::empty_body>;
  using Response = http::response<http::string_body>;

  void encrypt() {
    stream_.encrypt(*context_.tls);
    stream_.async_handshake(buffer_.cdata(), [self = shared_from_this()](error_code error, std::size_t used = 0) {
      if (error) return self->finish();
      self->buffer_.consume(used);
      self->read();
    });
  }

  bool is_from_here() const {
    error_code error;
    const auto other = stream_.socket().remote_endpoint(error);
    return !error &&
           (other.address().is_loopback() || other.address() == stream_.socket().local_endpoint(error).address());
  }

  void read() {
    is_served_ = false;
    stream_.expires_after(header_time);
    parser_.emplace();
    parser_->header_limit(16 * 1024);
    http::async_read_header(stream_, buffer_, *parser_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error) return self->refuse_unreadable(error);
      self->answer();
    });
  }

  /// Bytes that are not HTTP (such as https:// typed by mistake) or a too long header are answered before closing.
  void refuse_unreadable(error_code error) {
    static const auto& of_http = http::make_error_code(http::error::bad_version).category();
    if (error.category() != of_http || error == http::error::end_of_stream || error == http::error::partial_message) {
      return finish();
    }
    must_close_ = true, is_head_ = false;
    if (error == http::error::header_limit) {
      return send_text(http::status::request_header_fields_too_large, "the header of the request is too long");
    }
    send_text(http::status::bad_request, "this is not a request of HTTP/1.1");
  }

  void answer() {
    const Request& request = parser_->get();
    is_head_ = request.method() == http::verb::head;
    const auto target = parse_target(to_view(request.target()));
    role_ = target ? role_of(*target) : std::nullopt;
    if (const auto reason = refuse_by_host(request)) return refuse(*reason);
    if (must_redirect_) return send_to_https();
    if (!target) return send_text(http::status::bad_request, "malformed target");
    // An encoding that we do not know might hide a body from us that a proxy in front sees.
    if ((parser_->content_length() && *parser_->content_length() > 0) ||
        request.count(http::field::transfer_encoding) > 0) {
      must_close_ = true;  // the body is not read
      return send_text(http::status::bad_request, "no request here has a body");
    }
    if (target->path == "/ws") return upgrade();
    if (context_.requests.serves(target->path)) return ask_program(*target);
    if (websocket::is_upgrade(request)) return send_text(http::status::not_found, "the WebSocket is at /ws");
    if (request.method() != http::verb::get && !is_head_) {
      return send_text(http::status::method_not_allowed, "only GET and HEAD");
    }
    if (target->path == "/healthz") return send_text(http::status::ok, "ok");
    send_file(target->path);
  }

  std::optional<std::string> refuse_by_host(const Request& request) const {
    error_code error;
    const auto local = stream_.socket().local_endpoint(error);
    const Endpoint endpoint{context_.options.host, error ? std::string() : local.address().to_string(), context_.port,
                            stream_.scheme(), context_.options.public_origin};
    if (request.count(http::field::host) != 1) return "exactly one Host header is needed";
    return refuse_host(to_view(request[http::field::host]), endpoint);
  }

  /// By the token in its address; none for a wrong one.
  std::optional<protocol::Role> role_of(const RequestTarget& target) const {
    const std::string given = query_value(target.query, "token");
    std::optional<protocol::Role> found;
    if (equal_in_constant_time(given, context_.options.token)) found = protocol::Role::host;
    for (const auto& [token, role] : context_.options.other_tokens)
      if (equal_in_constant_time(given, token)) found = role;
    return found;
  }

  std::optional<std::string> refuse_by_origin(const Request& request) const {
    if (request.count(http::field::origin) > 1) return "more than one Origin header";
    if (request.count(http::field::origin) == 0) return std::nullopt;
    return refuse_origin(to_view(request[http::field::origin]), stream_.scheme(), to_view(request[http::field::host]),
                         context_.options.public_origin);
  }

  /// Waits for the program's answer.
  void ask_program(const RequestTarget& target) {
    const Request& request = parser_->get();
    const bool is_post = request.method() == http::verb::post;
    if (!is_post && request.method() != http::verb::get && !is_head_)
      return send_text(http::status::method_not_allowed, "only GET, HEAD and POST");
    is_open_ = context_.requests.is_open(target.path);
    if (!is_open_) {
      if (const auto reason = refuse_by_origin(request)) return refuse(*reason);
      if (!role_) return refuse(wrong_token);
    }
    is_served_ = true;
    stream_.expires_never();
    const std::uint64_t number =
        context_.requests.add({0, target.path, target.query, role_, is_post}, [weak = weak_from_this()](Answer answer) {
          if (const auto self = weak.lock()) self->pass_on(std::move(answer));
        });
    timer_.expires_after(std::chrono::duration_cast<std::chrono::milliseconds>(
        std::chrono::duration<double>(context_.options.answer_time)));
    timer_.async_wait([self = shared_from_this(), number](error_code error) {  // keeps the session
      self->context_.requests.remove(number);
      if (!error) self->send_text(http::status::gateway_timeout, "the program does not answer");
    });
  }

  void pass_on(Answer answer) {
    if (timer_.cancel() == 0) return;  // too late
    Response response = make_response(static_cast<http::status>(answer.status));
    response.set(http::field::content_type, answer.type);
    response.set(http::field::cache_control, "no-store");
    if (is_open_) {
      response.set(http::field::access_control_allow_origin, "*");
      response.set("Cross-Origin-Resource-Policy", "cross-origin");
    }
    response.body() = std::move(answer.body);
    send(std::move(response));
  }

  void upgrade() {
    const Request& request = parser_->get();
    if (!websocket::is_upgrade(request)) {
      return send_text(http::status::upgrade_required, "this is the WebSocket's address");
    }
    if (const auto reason = refuse_by_origin(request)) return refuse(*reason);
    if (!role_) return refuse(wrong_token);
    const auto target = parse_target(to_view(request.target()));
    const std::string world = target ? query_value(target->query, "world") : std::string();
    if (context_.relays.find(world)) return start_relay(std::move(stream_), request, world, *role_, context_);
    stream_.expires_never();
    std::make_shared<WebSocketSession>(std::move(stream_), context_, *role_)->start(request);
  }

  /// The address contains the token, so a plain answer is only the redirect to https.
  void send_to_https() {
    const Request& request = parser_->get();
    Response response = make_response(http::status::temporary_redirect);
    response.set(http::field::location,
                 std::string("https://").append(to_view(request[http::field::host])).append(to_view(request.target())));
    send(std::move(response));
  }

  void refuse(const std::string& reason) {
    ++context_.counters.upgrades_refused;
    must_close_ = true;
    send_text(http::status::forbidden, reason);
  }

  void send_file(const std::string& path) {
    const auto file =
        find_static_file(context_.options.page_folder, path, to_view(parser_->get()[http::field::accept_encoding]));
    if (!file) {
      return send_text(http::status::not_found,
                       path == "/" ? "the page has not been built: there is no index.html" : "there is no such file");
    }
    Response response = make_response(http::status::ok);
    response.set(http::field::etag, file->etag);
    response.set(http::field::vary, "Accept-Encoding");
    if (!file->encoding.empty())
      response.set(http::field::content_encoding, beast::string_view(file->encoding.data(), file->encoding.size()));
    response.set(http::field::cache_control,
                 beast::string_view(file->cache_control.data(), file->cache_control.size()));
    if (parser_->get()[http::field::if_none_match] == file->etag) {
      response.result(http::status::not_modified);
      return send(std::move(response));
    }
    auto contents = read_static_file(*file);
    if (!contents) return send_text(http::status::internal_server_error, "the file cannot be read");
    response.set(http::field::content_type, beast::string_view(file->mime_type.data(), file->mime_type.size()));
    // Only documents obey these, and they are longer than some scripts.
    if (file->mime_type.starts_with("text/javascript") || file->mime_type.starts_with("text/css"))
      for (const char* const name : {"Content-Security-Policy", "Cross-Origin-Opener-Policy", "Permissions-Policy"})
        response.erase(name);
    response.body() = std::move(*contents);
    send(std::move(response));
  }

  void send_text(http::status status, std::string_view text) {
    Response response = make_response(status);
    response.set(http::field::content_type, "text/plain; charset=utf-8");
    response.set(http::field::cache_control, "no-store");
    if (status == http::status::method_not_allowed) response.set(http::field::allow, "GET, HEAD");
    if (status == http::status::upgrade_required) response.set(http::field::upgrade, "websocket");
    response.body() = text;
    if (status != http::status::ok) response.body() += '\n';
    send(std::move(response));
  }

  /// As the browser sees it.
  Scheme page_scheme() const {
    const bool is_public = is_public_host(to_view(parser_->get()[http::field::host]), context_.options.public_origin);
    return is_public && context_.options.public_origin.starts_with("https:") ? Scheme::https : stream_.scheme();
  }

  Response make_response(http::status status) const {
    const Request& request = parser_->get();
    Response response{status, request.version() == 10 ? 10U : 11U};
    response.set(http::field::server, "iota");
    response.set("Content-Security-Policy", content_security_policy(page_scheme(), to_view(request[http::field::host]),
                                                                    role_.has_value(), context_.options.gateway));
    response.set("X-Content-Type-Options", "nosniff");
    response.set("Referrer-Policy", "no-referrer");  // the page's URL contains the token
    response.set("Cross-Origin-Opener-Policy", "same-origin");
    response.set("Cross-Origin-Resource-Policy", "same-origin");  // else another site could detect Iota here
    response.set("Permissions-Policy", "camera=(), microphone=(), geolocation=(), payment=(), usb=()");
    response.keep_alive(request.keep_alive() && !must_close_);
    return response;
  }

  void send(Response&& response) {
    if (response.result() == http::status::not_modified) {
      response.content_length(boost::none);
    } else {
      response.prepare_payload();
    }
    if (is_head_) response.body().clear();  // the length is that of the whole
    response_.emplace(std::move(response));
    is_served_ = true;
    stream_.expires_after(answer_time);
    const bool is_last = !response_->keep_alive();
    http::async_write(stream_, *response_, [self = shared_from_this(), is_last](error_code error, std::size_t) {
      if (error || self->context_.is_finishing) return self->finish();
      if (!is_last) return self->read();
      self->stream_.expires_after(close_time);
      self->stream_.async_shutdown_send([self](error_code) { self->discard(); });
    });
  }

  /// Closing with unread data would reset the connection, and the client might lose the answer.
  void discard() {
    buffer_.clear();
    stream_.async_read_some(buffer_.prepare(4096), [self = shared_from_this()](error_code error, std::size_t) {
      if (!error) self->discard();
    });
  }

  ConnectionContext& context_;
  Stream stream_;
  asio::steady_timer timer_;  // for the program's answer
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::empty_body>> parser_;
  std::optional<Response> response_;
  bool is_head_ = false;
  bool must_close_ = false;
  bool is_open_ = false;                // the request is for an open path
  std::optional<protocol::Role> role_;  // of the request that is answered
  bool must_redirect_ = false;
  bool is_served_ = false;
};

/// Whether one more connection is possible. If connections that are not welcomed have all their places, the oldest idle
/// one is closed; without an idle one, the oldest that is sent a file.
bool make_room(ConnectionContext& context) {
  std::size_t strangers = 0;
  OpenConnection* oldest = nullptr;
  for (OpenConnection* connection : context.open) {
    const Standing standing = connection->standing();
    if (standing == Standing::welcomed) continue;
    ++strangers;
    if (oldest == nullptr || (standing == Standing::idle && oldest->standing() == Standing::served))
      oldest = connection;
  }
  if (strangers >= max_strangers || (context.open.size() >= max_connections && oldest != nullptr)) {
    std::erase(context.open, oldest);  // destroyed after its handlers have run
    oldest->evict();
  }
  return context.open.size() < max_connections;
}

}  // namespace

std::unique_ptr<asio::ssl::context> make_tls(const Certificate& certificate) {
  if (certificate.chain.empty()) return nullptr;
  auto tls = std::make_unique<asio::ssl::context>(asio::ssl::context::tls_server);
  error_code error;
  SSL_CTX_set_min_proto_version(tls->native_handle(), TLS1_2_VERSION);
  tls->use_certificate_chain(asio::buffer(certificate.chain), error);
  if (!error) tls->use_private_key(asio::buffer(certificate.key), asio::ssl::context::pem, error);
  if (error) throw std::invalid_argument("the certificate or its key cannot be used: " + error.message());
  return tls;
}

void start_connection(tcp::socket socket, ConnectionContext& context) {
  if (context.is_finishing || !make_room(context)) return;  // closes it
  error_code ignored;
  socket.set_option(tcp::no_delay(true), ignored);
  std::make_shared<HttpSession>(std::move(socket), context)->start();
}

}  // namespace iota::net
