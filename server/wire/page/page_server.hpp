#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>

#include "server/wire/page/http/access.hpp"
#include "server/wire/page/orders.hpp"
#include "server/wire/page/page_model.hpp"

namespace isthmus {

struct PageOptions {
  std::string address = "127.0.0.1";
  int port = 0;       ///< 0: any that is free
  std::string token;  ///< see Access; must not be empty where the address is not of this machine alone
  std::string journal_directory;  ///< whose snapshots show the past; empty: none do
  bool orders_signed = false;     ///< keys are configured: orders must be in an envelope
  std::size_t viewers = 16;       ///< streams of events at once; further ones are refused
  std::size_t connections = 48;   ///< at once; further ones wait in the kernel, and take no descriptor
  std::chrono::milliseconds transfer_time{
      5000};                                   ///< to read some of a request, or to write some of an answer
  std::chrono::milliseconds order_time{5000};  ///< to wait for what becomes of an order
  std::chrono::milliseconds silence_time{10'000};  ///< without news, a stream says that it is alive
};

/// Serves the page over HTTP in threads of its own and of the lowest priority; README.md lists the resources.
class PageServer {
 public:
  /// Throws std::runtime_error with the reason where the port cannot be had, or a token is missing.
  PageServer(PageOptions options, TakeMessage take);
  /// Ends all streams; waits for requests under way, for `transfer_time` at most.
  ~PageServer();

  int port() const;
  PageModel& model();
  Orders& orders();

 private:
  class Site;
  std::unique_ptr<Site> site_;
};

}  // namespace isthmus
