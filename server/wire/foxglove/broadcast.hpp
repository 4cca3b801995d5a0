#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <string>
#include <string_view>

#include "server/wire/foxglove/outbox.hpp"
#include "server/wire/foxglove/protocol.hpp"

namespace isthmus::foxglove {

/// One who watches: what it has subscribed to, and what waits to be sent to it.
class Viewer {
 public:
  Viewer(Outbox::Limits limits, std::function<void()> wake) : outbox_(limits), wake_(std::move(wake)) {}

  Outbox& outbox() { return outbox_; }
  /// So much waits that it cannot be helped: it is to be let go.
  bool is_lost() const { return lost_; }

 private:
  friend class Broadcast;
  void tell(std::string control);

  Outbox outbox_;
  std::function<void()> wake_;
  bool lost_ = false;
  std::map<std::uint32_t, std::uint32_t> subscription_of_;  ///< by channel
};

/// Channels, and who has subscribed to them. One thread.
class Broadcast {
 public:
  /// `session` tells viewers one run of the server from the next.
  explicit Broadcast(std::string session, Outbox::Limits limits = {});

  /// A viewer that `wake` is called for when something waits for it; it is told what channels there are.
  Viewer& join(std::function<void()> wake);
  void leave(const Viewer& viewer);
  std::size_t viewers() const { return viewers_.size(); }
  /// What a viewer says.
  void hear(Viewer& viewer, std::string_view text);

  /// Whether each message counts, or only the newest, which those who come later are sent too.
  enum class Keep : std::uint8_t { newest, all };
  /// From now on there is a channel.
  void open(const std::string& topic, Kind kind, Keep keep);
  void close(const std::string& topic);
  bool has(const std::string& topic) const { return channels_.contains(topic); }
  /// Whether somebody listens; else a message need not be made.
  bool is_heard(const std::string& topic) const;
  /// On a channel that is open.
  void send(const std::string& topic, std::int64_t utime, std::string message);

 private:
  struct OpenChannel {
    FoxgloveChannel channel;
    Keep keep = Keep::all;
    int listeners = 0;
    std::int64_t newest_utime = 0;
    Text newest;  ///< none: there is none yet
  };

  void subscribe(Viewer& viewer, const Subscription& subscription);
  void unsubscribe(Viewer& viewer, std::uint32_t subscription);
  void hand_out(Viewer& viewer, const OpenChannel& open, std::int64_t utime, const Text& body);
  OpenChannel* find(std::uint32_t channel);

  std::string session_;
  Outbox::Limits limits_;
  std::list<Viewer> viewers_;
  std::map<std::string, OpenChannel> channels_;
  std::uint32_t next_id_ = 1;
};

}  // namespace isthmus::foxglove
