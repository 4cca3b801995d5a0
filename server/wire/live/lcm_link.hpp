#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "server/wire/intake/reception.hpp"
#include "server/wire/network/lcm_url.hpp"
#include "server/wire/network/udp_receiver.hpp"
#include "server/wire/watch/log_line.hpp"

namespace lcm {
class LCM;
}

namespace isthmus {

/// The server's end of an LCM network, for receiving and publishing; or of a log, for receiving.
class LcmLink {
 public:
  /// Throws std::runtime_error with what to do about it where the network cannot be opened. Logs when
  /// the network begins to refuse messages, and when it takes them again.
  explicit LcmLink(const std::string& completed_url, Log log = {});
  ~LcmLink();

  /// Starts a thread that copies messages on input channels into the inbox, until `stop` or the log's end. A
  /// log waits for the inbox; a network does not. Envelopes are opened; where keys are configured, a
  /// network's messages without one are refused; a log's are taken: who may write to it may do worse.
  void receive_into(Inbox& inbox, const ChannelNames& configured,
                    Authenticator authenticator = Authenticator(), ReceptionWatch watch = {});
  /// A message that came another way than by the network or log, taken as if from a network: the same keys,
  /// the same queue. Returns why it was refused; none: it waits for its turn. After `receive_into`, any
  /// thread.
  DropReason take(const std::string& channel, std::span<const std::uint8_t> bytes);
  /// Whether the log's end has been reached.
  bool ended() const { return ended_; }
  /// Waits for the thread. A log that waits for room in the inbox goes on only when the inbox is closed or
  /// emptied.
  void stop();

  /// Any thread; never throws. Messages that the network refused are counted.
  void publish(const std::string& channel, const std::vector<std::uint8_t>& bytes);
  std::int64_t publish_failures() const { return publish_failures_; }

 private:
  void receive_udp(const std::stop_token& stop);
  void receive_queue(const std::stop_token& stop);
  void note_receiving(bool fails);
  void receive_log(const std::stop_token& stop);
  void note(std::atomic<bool>& failing, bool fails, const char* begins, const char* ends) const;

  Log log_;
  std::string log_file_;
  std::unique_ptr<lcm::LCM> lcm_;     ///< none for a log
  std::unique_ptr<UdpReceiver> udp_;  ///< for UDP, where liblcm only publishes
  std::unique_ptr<struct LcmSubscriber> subscriber_;
  std::atomic<bool> ended_ = false;
  std::atomic<std::int64_t> publish_failures_ = 0;
  std::atomic<bool> publishing_fails_ = false;
  std::atomic<bool> receiving_fails_ = false;
  std::jthread thread_;
};

}  // namespace isthmus
