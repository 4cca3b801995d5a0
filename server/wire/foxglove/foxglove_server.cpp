#include "server/wire/foxglove/foxglove_server.hpp"

#include <array>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <functional>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>
#include <variant>

#include "server/wire/foxglove/admission.hpp"
#include "server/wire/questions/low_priority.hpp"

namespace isthmus {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using foxglove::Broadcast;
using foxglove::MapFeed;
using foxglove::Outbox;
using foxglove::Viewer;
using Error = beast::error_code;

constexpr std::uint32_t largest_head = 8192;
constexpr std::size_t largest_request = 65'536;
constexpr std::size_t fragment_bytes = 65'536;
/// Poses and scans that wait for the thread; beyond, nobody could follow.
constexpr std::size_t most_waiting = 10'000;

std::string text(beast::string_view view) { return {view.data(), view.size()}; }

/// What the connections of a server share. One thread.
struct Shared {
  Shared(asio::io_context& at, const FoxgloveOptions& given)
      : io(at),
        options(given),
        access(given.token),
        broadcast(std::to_string(std::chrono::system_clock::now().time_since_epoch().count()), given.outbox),
        feed(broadcast, given.feed) {}

  asio::io_context& io;
  const FoxgloveOptions& options;
  Access access;
  Broadcast broadcast;
  MapFeed feed;
  std::atomic<bool> wants_scans = false;
  std::size_t viewers = 0;
  std::function<void()> connection_ended;
};

/// One connection: the handshake, then a viewer until it leaves or does not take what it is sent.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(tcp::socket socket, Shared& shared)
      : shared_(shared), socket_(std::move(socket)), too_slow_(shared.io) {}

  void start() {
    parser_.header_limit(largest_head);
    parser_.body_limit(std::uint64_t{0});
    lowest().expires_after(shared_.options.handshake_time);
    http::async_read(lowest(), buffer_, parser_,
                     [self = shared_from_this()](Error error, std::size_t) { self->answer(error); });
  }

 private:
  beast::tcp_stream& lowest() { return beast::get_lowest_layer(socket_); }

  void answer(Error error) {
    if (error) return end();
    const auto& request = parser_.get();
    const foxglove::Handshake handshake = {
        text(request.target()), text(request[http::field::host]), text(request[http::field::origin]),
        text(request[http::field::authorization]), text(request[http::field::sec_websocket_protocol])};
    const std::string_view protocol = foxglove::subprotocol_for(handshake);
    if (!websocket::is_upgrade(request)) return refuse(http::status::upgrade_required, "a WebSocket is here");
    if (!foxglove::may_watch(shared_.access, handshake))
      return refuse(shared_.access.needs_token() ? http::status::unauthorized : http::status::forbidden,
                    "who may watch: see --http-token-file");
    if (protocol.empty()) return refuse(http::status::bad_request, "foxglove.websocket.v1 is spoken here");
    if (shared_.viewers >= shared_.options.viewers)
      return refuse(http::status::service_unavailable, "there are as many viewers as there may be");
    accept(std::string(protocol));
  }

  void refuse(http::status status, const std::string& why) {
    refusal_.result(status);
    refusal_.keep_alive(false);
    refusal_.body() = why + "\n";
    refusal_.prepare_payload();
    http::async_write(lowest(), refusal_, [self = shared_from_this()](Error, std::size_t) { self->end(); });
  }

  void accept(const std::string& protocol) {
    has_seat_ = true;
    shared_.viewers += 1;
    lowest().expires_never();
    websocket::stream_base::timeout limits;
    limits.handshake_timeout = shared_.options.handshake_time;
    limits.idle_timeout = shared_.options.message_time;
    limits.keep_alive_pings = true;
    socket_.set_option(limits);
    socket_.set_option(websocket::stream_base::decorator([protocol](websocket::response_type& response) {
      response.set(http::field::sec_websocket_protocol, protocol);
    }));
    socket_.read_message_max(largest_request);
    socket_.write_buffer_bytes(fragment_bytes);
    socket_.async_accept(parser_.get(), [self = shared_from_this()](Error error) { self->join(error); });
  }

  void join(Error error) {
    if (error) return end();
    Error ignored;
    lowest().socket().set_option(tcp::no_delay(true), ignored);
    buffer_.consume(buffer_.size());
    viewer_ = &shared_.broadcast.join([this] { wake(); });
    read();
  }

  void read() {
    socket_.async_read(buffer_, [self = shared_from_this()](Error error, std::size_t) {
      if (error || !self->viewer_) return self->end();
      const std::string said = beast::buffers_to_string(self->buffer_.data());
      self->buffer_.consume(self->buffer_.size());
      self->shared_.broadcast.hear(*self->viewer_, said);
      self->shared_.wants_scans = self->shared_.feed.wants_scans();
      self->read();
    });
  }

  /// Called from within the broadcast: what is done about it comes afterwards.
  void wake() {
    if (is_woken_) return;
    is_woken_ = true;
    asio::post(shared_.io, [self = shared_from_this()] {
      self->is_woken_ = false;
      self->write();
    });
  }

  void write() {
    if (!viewer_ || is_writing_) return;
    if (viewer_->is_lost()) return end();
    std::optional<Outbox::Item> next = viewer_->outbox().next();
    if (!next) return;
    is_writing_ = true;
    sending_ = std::move(*next);
    too_slow_.expires_after(shared_.options.message_time);
    too_slow_.async_wait([self = shared_from_this()](Error error) {
      if (!error) self->end();
    });
    socket_.binary(sending_.is_data);
    const std::array<asio::const_buffer, 2> parts = {asio::buffer(sending_.head),
                                                     asio::buffer(*sending_.body)};
    socket_.async_write(parts, [self = shared_from_this()](Error error, std::size_t) {
      self->is_writing_ = false;
      self->too_slow_.cancel();
      if (error) return self->end();
      self->write();
    });
  }

  void end() {
    if (std::exchange(has_ended_, true)) return;
    if (viewer_) shared_.broadcast.leave(*std::exchange(viewer_, nullptr));
    shared_.wants_scans = shared_.feed.wants_scans();
    if (has_seat_) shared_.viewers -= 1;
    too_slow_.cancel();
    lowest().close();
    if (shared_.connection_ended) shared_.connection_ended();
  }

  Shared& shared_;
  websocket::stream<beast::tcp_stream> socket_;
  asio::steady_timer too_slow_;
  beast::flat_buffer buffer_;
  http::request_parser<http::empty_body> parser_;
  http::response<http::string_body> refusal_;
  Outbox::Item sending_;
  Viewer* viewer_ = nullptr;  ///< once it has joined, until it ends
  bool has_seat_ = false;
  bool is_woken_ = false;
  bool is_writing_ = false;
  bool has_ended_ = false;
};

tcp::endpoint endpoint_of(const FoxgloveOptions& options) {
  const std::string address = options.address == "localhost" ? "127.0.0.1" : options.address;
  Error error;
  const asio::ip::address parsed = asio::ip::make_address(address, error);
  if (error) throw std::runtime_error("not an address: " + options.address);
  return {parsed, static_cast<std::uint16_t>(options.port)};
}

}  // namespace

class FoxgloveServer::Site {
 public:
  explicit Site(FoxgloveOptions options)
      : options_(std::move(options)), shared_(io_, options_), acceptor_(io_) {
    if (!is_loopback(options_.address) && !shared_.access.needs_token())
      throw std::runtime_error("a map that others can watch needs a token (--http-token-file)");
    listen();
    shared_.connection_ended = [this] {
      connections_ -= 1;
      accept();
    };
    accept();
    thread_ = std::jthread([this] {
      take_low_priority();
      io_.run();
    });
  }

  ~Site() {
    io_.stop();
    thread_.join();
    shared_.connection_ended = nullptr;
  }

  int port() const { return acceptor_.local_endpoint().port(); }

  void show(const RobotPose& pose) { give(pose); }

  void show(const Event& event) {
    if (const auto* robot = std::get_if<RobotEvent>(&event.body)) give(*robot);
    const auto* scan = std::get_if<ScanEvent>(&event.body);
    if (scan && shared_.wants_scans) give(*scan);
  }

  void show(std::shared_ptr<const MapCopy> map, const status_t& status) {
    View view{std::move(map), status};
    const std::lock_guard lock(mutex_);
    std::swap(view_, view);  // one that was not looked at goes with `view`
    call();
  }

 private:
  struct View {
    std::shared_ptr<const MapCopy> map;
    status_t status;
  };
  using Given = std::variant<RobotPose, RobotEvent, ScanEvent>;

  void listen() {
    try {
      const tcp::endpoint endpoint = endpoint_of(options_);
      acceptor_.open(endpoint.protocol());
      acceptor_.set_option(asio::socket_base::reuse_address(true));
      acceptor_.bind(endpoint);
      acceptor_.listen();
    } catch (const boost::system::system_error& error) {
      throw std::runtime_error("cannot serve Foxglove at " + options_.address + ":" +
                               std::to_string(options_.port) + ": " + error.code().message());
    }
  }

  /// The next connection, where there may be one more.
  void accept() {
    if (is_accepting_ || connections_ >= options_.connections) return;
    is_accepting_ = true;
    acceptor_.async_accept([this](Error error, tcp::socket socket) {
      is_accepting_ = false;
      if (error) return accept_later();
      connections_ += 1;
      std::make_shared<Connection>(std::move(socket), shared_)->start();
      accept();
    });
  }

  /// Descriptors may be used up.
  void accept_later() {
    constexpr std::chrono::milliseconds pause{200};
    pause_.expires_after(pause);
    pause_.async_wait([this](Error error) {
      if (!error) accept();
    });
  }

  template <class Item>
  void give(const Item& item) {
    const std::lock_guard lock(mutex_);
    if (given_.size() >= most_waiting) return;
    given_.emplace_back(item);
    call();
  }

  /// The thread, once for all that waits.
  void call() {
    if (std::exchange(is_called_, true)) return;
    asio::post(io_, [this] { take(); });
  }

  void take() {
    std::unique_lock lock(mutex_);
    is_called_ = false;
    const std::vector<Given> given = std::exchange(given_, {});
    const View view = std::exchange(view_, {});
    lock.unlock();
    for (const Given& one : given) std::visit([&](const auto& item) { shared_.feed.show(item); }, one);
    if (view.map) shared_.feed.show(*view.map, view.status, MapFeed::Clock::now());
  }

  FoxgloveOptions options_;
  asio::io_context io_{1};
  Shared shared_;
  tcp::acceptor acceptor_;
  asio::steady_timer pause_{io_};
  bool is_accepting_ = false;
  std::size_t connections_ = 0;
  std::mutex mutex_;
  std::vector<Given> given_;
  View view_;
  bool is_called_ = false;
  std::jthread thread_;  ///< last: it uses all above
};

FoxgloveServer::FoxgloveServer(FoxgloveOptions options) : site_(std::make_unique<Site>(std::move(options))) {}

FoxgloveServer::~FoxgloveServer() = default;

int FoxgloveServer::port() const { return site_->port(); }
void FoxgloveServer::show(const RobotPose& pose) { site_->show(pose); }
void FoxgloveServer::show(const Event& event) { site_->show(event); }
void FoxgloveServer::show(std::shared_ptr<const MapCopy> map, const status_t& status) {
  site_->show(std::move(map), status);
}

}  // namespace isthmus
