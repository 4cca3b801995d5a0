#include "server/wire/watch/http_connection.hpp"

#include <sys/socket.h>

#include <array>
#include <cerrno>

namespace isthmus {
namespace {

bool is_whole(const std::string& head) { return head.find("\r\n\r\n") != std::string::npos; }

bool may_go_on() { return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR; }

}  // namespace

HttpRequest parse_http_request(std::string_view head) {
  const std::string_view line = head.substr(0, head.find("\r\n"));
  const std::size_t target = line.find(' ');
  const std::size_t version = line.rfind(' ');
  if (target == std::string_view::npos || version <= target || !line.substr(version).starts_with(" HTTP/1."))
    return {};
  const std::string_view path = line.substr(target + 1, version - target - 1);
  return {line.substr(0, target), path.substr(0, path.find('?'))};
}

bool HttpConnection::step(const std::function<std::string(std::string_view)>& answer,
                          std::size_t request_bytes) {
  if (is_answering()) return write();
  if (!read(request_bytes)) return false;
  if (!is_whole(request_) && request_.size() < request_bytes) return true;
  answer_ = answer(request_);
  return write();
}

/// False where the client has gone.
bool HttpConnection::read(std::size_t request_bytes) {
  std::array<char, 4096> bytes;
  while (!is_whole(request_) && request_.size() < request_bytes) {
    const ssize_t size = ::recv(socket_.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (size < 0) return may_go_on();
    if (size == 0) return false;
    request_.append(bytes.data(), static_cast<std::size_t>(size));
  }
  return true;
}

/// False when all is written, or the client has gone.
bool HttpConnection::write() {
  while (written_ < answer_.size()) {
    const ssize_t size = ::send(socket_.get(), answer_.data() + written_, answer_.size() - written_,
                                MSG_DONTWAIT | MSG_NOSIGNAL);
    if (size < 0) return may_go_on();
    written_ += static_cast<std::size_t>(size);
  }
  return false;
}

}  // namespace isthmus
