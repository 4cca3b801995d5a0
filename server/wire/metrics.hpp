#pragma once

#include <memory>
#include <string>

#include "isthmus/status_t.hpp"

namespace isthmus {

/// The counters of ISTHMUS_STATUS in Prometheus' text format (version 0.0.4).
std::string metrics_text(const status_t& status);

/// Serves the latest text at http://127.0.0.1:PORT/metrics, to this machine only, in a thread of its own.
class MetricsServer {
 public:
  /// Port 0: any that is free. Throws std::runtime_error where the port is taken.
  explicit MetricsServer(int port);
  ~MetricsServer();

  int port() const;
  void set(std::string text);  ///< any thread

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace isthmus
