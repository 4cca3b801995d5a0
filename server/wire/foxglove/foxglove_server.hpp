#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>

#include "isthmus/status_t.hpp"
#include "server/engine/input/event.hpp"
#include "server/engine/record/map_copy.hpp"
#include "server/engine/robot/robot_pose.hpp"
#include "server/wire/foxglove/map_feed.hpp"

namespace isthmus {

struct FoxgloveOptions {
  std::string address = "127.0.0.1";
  int port = 0;                  ///< 0: any that is free
  std::string token;             ///< empty: only this machine may watch; the address must be its own then
  std::size_t viewers = 16;      ///< at once; further ones are told 503
  std::size_t connections = 48;  ///< at once, viewers included; further ones wait in the kernel
  std::chrono::milliseconds handshake_time{5000};  ///< until a connection has become a viewer
  std::chrono::milliseconds message_time{30'000};  ///< for a viewer to take one message
  foxglove::Outbox::Limits outbox;
  foxglove::MapFeed::Options feed;
};

/// Serves Foxglove and Lichtblick over WebSocket in a thread of its own, of the lowest priority: giving it
/// something costs the live server a copy, and never waits. README.md tells what viewers see, and who may.
class FoxgloveServer {
 public:
  /// Throws std::runtime_error with the reason where the port cannot be had, or a token is missing.
  explicit FoxgloveServer(FoxgloveOptions options);
  /// Ends all connections.
  ~FoxgloveServer();

  int port() const;
  /// From any thread.
  void show(const RobotPose& pose);
  void show(const Event& event);
  void show(std::shared_ptr<const MapCopy> map, const status_t& status);

 private:
  class Site;
  std::unique_ptr<Site> site_;
};

}  // namespace isthmus
