#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "server/wire/file/file_bytes.hpp"

namespace isthmus {

/// What one page may cost, whoever connects.
struct HttpLimits {
  /// Each takes a descriptor, of 1024 that a process usually has. Where one more comes the oldest is closed:
  /// one that sends its request is answered at once, so that idle ones do not keep it out.
  std::size_t connections = 16;
  std::chrono::milliseconds exchange_time{5000};  ///< from connecting to the last byte of the answer
  std::size_t request_bytes = 8192;               ///< of the request's head
};

/// Serves one text at http://127.0.0.1:PORT/PATH, to this machine only, in a thread of its own (HTTP/1.1, GET
/// and HEAD, one request a connection).
class HttpPage {
 public:
  /// Port 0: any that is free. Throws std::runtime_error with the reason where the port cannot be had.
  HttpPage(int port, std::string path, std::string content_type, HttpLimits limits = {});
  /// Closes all connections; waits for none.
  ~HttpPage();

  int port() const { return port_; }
  void set(std::string text);  ///< any thread

 private:
  class Loop;

  std::string answer(std::string_view head) const;

  std::string path_;
  std::string content_type_;
  HttpLimits limits_;
  FileHandle listener_;
  FileHandle wake_;  ///< readable once the thread is to end
  int port_ = 0;
  mutable std::mutex mutex_;
  std::string text_;
  std::jthread thread_;
};

}  // namespace isthmus
