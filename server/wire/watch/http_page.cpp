#include "server/wire/watch/http_page.hpp"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <list>
#include <stdexcept>
#include <utility>
#include <vector>

#include "server/wire/watch/http_connection.hpp"

namespace isthmus {
namespace {

using Clock = HttpConnection::Clock;

constexpr std::chrono::milliseconds descriptors_wait(100);  ///< until accepting is tried again without any

FileHandle listening_socket(int port) {
  FileHandle socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const int yes = 1;
  // Not SO_REUSEPORT, with which a second server would share the port in silence.
  ::setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      ::listen(socket.get(), SOMAXCONN) != 0)
    throw std::runtime_error("port " + std::to_string(port) +
                             " of 127.0.0.1 cannot be had: " + errno_text(errno));
  return socket;
}

int port_of(const FileHandle& socket) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  ::getsockname(socket.get(), reinterpret_cast<sockaddr*>(&address), &size);
  return ntohs(address.sin_port);
}

std::string response(const std::string& status, const std::string& type, const std::string& body,
                     bool with_body) {
  return "HTTP/1.1 " + status + "\r\nContent-Type: " + type +
         "\r\nContent-Length: " + std::to_string(body.size()) + "\r\nConnection: close\r\n\r\n" +
         (with_body ? body : "");
}

}  // namespace

/// The open connections, oldest first, and what they wait for.
class HttpPage::Loop {
 public:
  explicit Loop(const HttpPage& page) : page_(page) {}

  void run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      const std::vector<pollfd> waits = wait();
      answer_those_ready(waits, stop);
      if (waits.front().revents != 0) accept_all();
      std::erase_if(connections_,
                    [](const auto& connection) { return connection.deadline() < Clock::now(); });
    }
  }

 private:
  /// Of the listener, the wake-up and the connections, in this order.
  std::vector<pollfd> wait() const {
    const bool listens = Clock::now() >= accepts_again_;
    std::vector<pollfd> waits = {{listens ? page_.listener_.get() : -1, POLLIN, 0},
                                 {page_.wake_.get(), POLLIN, 0}};
    Clock::time_point until = listens ? Clock::time_point::max() : accepts_again_;
    for (const HttpConnection& connection : connections_) {
      const auto events = static_cast<short>(connection.is_answering() ? POLLOUT : POLLIN);
      waits.push_back({connection.socket(), events, 0});
      until = std::min(until, connection.deadline());
    }
    int wait_ms = -1;
    if (until != Clock::time_point::max()) {
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now()).count();
      wait_ms = static_cast<int>(std::max<std::int64_t>(left + 1, 0));
    }
    if (::poll(waits.data(), waits.size(), wait_ms) < 0) {
      for (pollfd& one : waits) one.revents = 0;
    }
    return waits;
  }

  void answer_those_ready(const std::vector<pollfd>& waits, const std::stop_token& stop) {
    const auto answer = [this](std::string_view head) { return page_.answer(head); };
    auto wait = waits.begin() + 2;
    for (auto connection = connections_.begin(); connection != connections_.end(); ++wait) {
      if (stop.stop_requested()) return;  // an answer may be long
      const bool stays = wait->revents == 0 || connection->step(answer, page_.limits_.request_bytes);
      connection = stays ? std::next(connection) : connections_.erase(connection);
    }
  }

  void accept_all() {
    // No more at once than there is room for, so that one that has sent its request gets its turn.
    for (std::size_t i = 0; i < page_.limits_.connections; ++i) {
      FileHandle socket(::accept4(page_.listener_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
      if (!socket.is_open()) {
        if (errno == EMFILE || errno == ENFILE) accepts_again_ = Clock::now() + descriptors_wait;
        return;
      }
      if (connections_.size() >= page_.limits_.connections) connections_.pop_front();
      connections_.emplace_back(std::move(socket), Clock::now() + page_.limits_.exchange_time);
    }
  }

  const HttpPage& page_;
  std::list<HttpConnection> connections_;
  Clock::time_point accepts_again_ = Clock::time_point::min();
};

HttpPage::HttpPage(int port, std::string path, std::string content_type, HttpLimits limits)
    : path_(std::move(path)),
      content_type_(std::move(content_type)),
      limits_(limits),
      listener_(listening_socket(port)),
      wake_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
      port_(port_of(listener_)) {
  if (!wake_.is_open()) throw std::runtime_error(errno_text(errno));
  thread_ = std::jthread([this](const std::stop_token& stop) { Loop(*this).run(stop); });
}

HttpPage::~HttpPage() {
  thread_.request_stop();
  ::eventfd_write(wake_.get(), 1);
  thread_.join();
}

void HttpPage::set(std::string text) {
  const std::lock_guard lock(mutex_);
  text_.swap(text);
}

std::string HttpPage::answer(std::string_view head) const {
  const HttpRequest request = parse_http_request(head);
  const std::string plain = "text/plain";
  if (request.method.empty()) return response("400 Bad Request", plain, "", true);
  const bool is_head = request.method == "HEAD";
  if (!is_head && request.method != "GET") return response("405 Method Not Allowed", plain, "", true);
  if (request.path != path_) return response("404 Not Found", plain, "", true);
  const std::lock_guard lock(mutex_);
  return response("200 OK", content_type_, text_, !is_head);
}

}  // namespace isthmus
