#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

#include "server/wire/file/file_bytes.hpp"

namespace isthmus {

/// A request's first line; both empty where there is none.
struct HttpRequest {
  std::string_view method;
  std::string_view path;  ///< without the query
};

/// Reads the first line of a request's head.
HttpRequest parse_http_request(std::string_view head);

/// One exchange with one client, a step whenever its socket is ready; never waits.
class HttpConnection {
 public:
  using Clock = std::chrono::steady_clock;

  HttpConnection(FileHandle socket, Clock::time_point deadline)
      : socket_(std::move(socket)), deadline_(deadline) {}

  int socket() const { return socket_.get(); }
  Clock::time_point deadline() const { return deadline_; }
  bool is_answering() const { return !answer_.empty(); }  ///< waits to write, not to read

  /// Reads or writes what the socket takes. `answer` makes an answer of a request's whole head, which has at
  /// most `request_bytes`, or of what came of a longer one. False when the exchange is over or broken.
  bool step(const std::function<std::string(std::string_view head)>& answer, std::size_t request_bytes);

 private:
  bool read(std::size_t request_bytes);
  bool write();

  FileHandle socket_;
  Clock::time_point deadline_;
  std::string request_;
  std::string answer_;
  std::size_t written_ = 0;
};

}  // namespace isthmus
