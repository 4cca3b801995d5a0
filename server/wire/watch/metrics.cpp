#include "server/wire/watch/metrics.hpp"

#include <charconv>
#include <string_view>
#include <utility>

namespace isthmus {
namespace {

/// A label's value, with what the format gives a meaning escaped.
std::string escaped(const std::string& value) {
  std::string text;
  for (const char c : value) {
    if (c == '\\' || c == '"') text += '\\';
    if (c == '\n') {
      text += "\\n";
    } else {
      text += c;
    }
  }
  return text;
}

std::string label(std::string_view name, const std::string& value) {
  return std::string(name) + "=\"" + escaped(value) + "\"";
}

std::string decimal(std::int64_t value) { return std::to_string(value); }

std::string decimal(double value) {
  char text[32];
  const auto [end, error] = std::to_chars(text, text + sizeof text, value);
  return {text, end};
}

class MetricsText {
 public:
  void begin(std::string_view name, std::string_view type, std::string_view help) {
    name_ = "isthmus_" + std::string(name);
    text_ +=
        "# HELP " + name_ + " " + std::string(help) + "\n# TYPE " + name_ + " " + std::string(type) + "\n";
  }
  template <class Value>
  void add(Value value, const std::string& labels = "") {
    text_ += name_ + (labels.empty() ? "" : "{" + labels + "}") + " " + decimal(value) + "\n";
  }
  template <class Value>
  void counter(std::string_view name, std::string_view help, Value value) {
    begin(name, "counter", help);
    add(std::int64_t{value});
  }
  template <class Value>
  void gauge(std::string_view name, std::string_view help, Value value) {
    begin(name, "gauge", help);
    add(std::int64_t{value});
  }
  std::string take() { return std::move(text_); }

 private:
  std::string name_;
  std::string text_;
};

void add_map(MetricsText& text, const status_t& status) {
  text.counter("events_total", "Events taken by the engine.", status.events);
  text.counter("scans_total", "Scans taken.", status.scans);
  text.counter("scans_matched_total", "Scans localised by matching.", status.scans_matched);
  text.gauge("patches", "Patches on the map.", status.patches);
  text.gauge("relations", "Relations between patches.", status.relations);
  text.gauge("islands", "Islands of the map.", status.islands);
  text.begin("closures", "gauge", "Closures and merges, by state.");
  text.add(std::int64_t{status.closures}, label("state", "accepted"));
  text.add(std::int64_t{status.closures_refused}, label("state", "refused"));
  text.add(std::int64_t{status.closures_waiting}, label("state", "waiting"));
  text.add(std::int64_t{status.closures_withdrawn}, label("state", "withdrawn"));
  text.counter("sightings_total", "Sightings taken.", status.sightings);
  text.begin("sightings", "gauge", "Sightings, by what became of them so far.");
  text.add(status.sightings_accepted, label("verdict", "accepted"));
  text.add(status.sightings_refused, label("verdict", "refused"));
  text.add(status.sightings_waiting, label("verdict", "waiting"));
}

void add_server(MetricsText& text, const status_t& status) {
  text.gauge("queued_messages", "Messages received and not yet handled.", status.queued);
  text.counter("journal_bytes_total", "Bytes written to the journal.", status.journal_bytes);
  text.counter("journal_failures_total", "Events that the disk did not take at once.",
               status.journal_failures);
  text.gauge("journal_waiting_events", "Events that wait in memory for the disk.", status.journal_waiting);
  text.counter("publish_failures_total", "Messages of the server that the network refused.",
               status.publish_failures);
  text.counter("clock_steps_total", "Times that the wall clock was set while the server ran.",
               status.clock_steps);
  text.begin("questions_total", "counter",
             "Questions on ISTHMUS_REQUEST: answered, or why they were refused.");
  for (const count_t& asked : status.questions) text.add(asked.count, label("outcome", asked.reason));
  text.begin("dropped_total", "counter", "Messages of all robots that were dropped, by reason.");
  for (const count_t& dropped : status.dropped) text.add(dropped.count, label("reason", dropped.reason));
}

void add_robots(MetricsText& text, const status_t& status) {
  const auto each = [&](std::string_view name, std::string_view type, std::string_view help, auto value) {
    text.begin(name, type, help);
    for (const robot_status_t& robot : status.robots) {
      if (robot.last_heard_utime > 0) text.add(value(robot), label("robot", robot.robot));
    }
  };
  each("robot_last_heard_seconds", "gauge", "Receive time of a robot's last message, Unix time.",
       [](const robot_status_t& robot) { return 1e-6 * static_cast<double>(robot.last_heard_utime); });
  each("robot_message_rate_hertz", "gauge", "Messages of a robot in the last seconds.",
       [](const robot_status_t& robot) { return robot.message_rate_hz; });
  each("robot_scan_rate_hertz", "gauge", "Scans of a robot answered in the last seconds.",
       [](const robot_status_t& robot) { return robot.scan_rate_hz; });
  each("robot_scans_total", "counter", "Scans of a robot answered.",
       [](const robot_status_t& robot) { return robot.scans; });
  each("robot_share_matched", "gauge", "Share of a robot's scans that were matched.",
       [](const robot_status_t& robot) { return robot.share_matched; });
  text.begin("robot_dropped_total", "counter", "Messages of a robot that were dropped, by reason.");
  for (const robot_status_t& robot : status.robots) {
    for (const count_t& dropped : robot.dropped)
      text.add(dropped.count, label("robot", robot.robot) + "," + label("reason", dropped.reason));
  }
}

void add_warnings(MetricsText& text, const status_t& status) {
  text.begin("warning", "gauge", "1 for each warning that holds now.");
  for (const warning_t& warning : status.warnings)
    text.add(std::int64_t{1}, label("kind", warning.kind) + "," + label("robot", warning.robot));
}

}  // namespace

std::string metrics_text(const status_t& status) {
  MetricsText text;
  add_map(text, status);
  add_server(text, status);
  add_robots(text, status);
  add_warnings(text, status);
  return text.take();
}

}  // namespace isthmus
