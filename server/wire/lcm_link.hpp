#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "server/wire/authenticator.hpp"
#include "server/wire/inbox.hpp"
#include "server/wire/log_line.hpp"

namespace lcm {
class LCM;
}

namespace isthmus {

/// An LCM URL as liblcm reads it, udpm://239.255.76.67:7667?ttl=0 or memq://. For UDP the large receive
/// buffer that scans need is asked for, unless the URL asks for another. A URL file:///path is a log or
/// journal, read from its beginning to its end as fast as the engine takes it, with the times of the log.
std::string complete_lcm_url(const std::string& url);

/// What the user should know of a URL: messages that leave the machine, a receive buffer that the kernel
/// clips to `kernel_buffer_bytes` (net.core.rmem_max).
std::vector<std::string> lcm_url_warnings(const std::string& completed_url, std::int64_t kernel_buffer_bytes);

/// The log that a file:// URL names; empty for other URLs.
std::string log_file_of(const std::string& url);

/// net.core.rmem_max; 0 where it cannot be read.
std::int64_t kernel_receive_buffer_bytes();

/// The server's end of an LCM network, for receiving and publishing; or of a log, for receiving.
class LcmLink {
 public:
  /// Throws std::runtime_error with what to do about it where the network cannot be opened. The log is told
  /// when the network begins to refuse messages, and when it takes them again.
  explicit LcmLink(const std::string& completed_url, Log log = {});
  ~LcmLink();

  /// Starts a thread that copies messages on input channels into the inbox, until `stop` or the log's end. A
  /// log waits for the inbox; a network does not. Envelopes are opened; where keys are configured, a
  /// network's messages without one are refused; a log's are taken: who may write to it may do worse.
  void receive_into(Inbox& inbox, const Configuration& configuration,
                    Authenticator authenticator = Authenticator());
  /// Whether the log's end has been reached.
  bool ended() const { return ended_; }
  /// Waits for the thread. A log that waits for room in the inbox goes on only when the inbox is closed or
  /// emptied.
  void stop();

  /// Any thread; never throws. Messages that the network refused are counted.
  void publish(const std::string& channel, const std::vector<std::uint8_t>& bytes);
  std::int64_t publish_failures() const { return publish_failures_; }

 private:
  void receive_network(const std::stop_token& stop);
  void receive_log(const std::stop_token& stop);
  void note(std::atomic<bool>& failing, bool fails, const char* begins, const char* ends) const;

  Log log_;
  std::string log_file_;
  std::unique_ptr<lcm::LCM> lcm_;  ///< none for a log
  std::unique_ptr<struct LcmHandler> handler_;
  std::atomic<bool> ended_ = false;
  std::atomic<std::int64_t> publish_failures_ = 0;
  std::atomic<bool> publishing_fails_ = false;
  std::atomic<bool> receiving_fails_ = false;
  std::jthread thread_;
};

}  // namespace isthmus
