#include "server/wire/live_server.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "server/output/output.hpp"
#include "server/wire/encoded.hpp"
#include "server/wire/message.hpp"

namespace isthmus {
namespace {

using Clock = std::chrono::steady_clock;

double seconds(Clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

/// Configurations and ticks are the server's own entries in its journal: nobody may send them.
bool is_own(const Event& event) {
  return std::holds_alternative<ConfigurationEvent>(event.body) ||
         std::holds_alternative<TickEvent>(event.body);
}

bool asks_for_map(const Event& event) {
  const auto* command = std::get_if<CommandEvent>(&event.body);
  return command && command->verb == "send_map";
}

}  // namespace

LiveServer::LiveServer(LiveOptions options, Inbox& inbox, Publish publish)
    : options_(std::move(options)), inbox_(inbox), publish_(std::move(publish)) {
  const auto parsed = parse_configuration(options_.toml, "configuration");
  if (const std::string* error = std::get_if<std::string>(&parsed)) throw std::runtime_error(*error);
  start_ = last_event_ = last_status_ = Clock::now();
  last_utime_ = options_.clock ? options_.clock() : options_.start_utime;
  const Event configuration{last_utime_, ConfigurationEvent{options_.toml}};
  if (!options_.journal_directory.empty()) {
    journal_ = std::make_unique<Journal>(options_.journal_directory, encode(configuration), options_.journal);
  }
  take(configuration);
  map_publisher_ = std::make_unique<MapPublisher>(publish_, options_.map);
}

LiveServer::~LiveServer() = default;

void LiveServer::run() {
  while (!inbox_.finished()) {
    if (std::optional<Message> message = inbox_.pop(options_.tick_interval)) {
      handle(std::move(*message));
    } else {
      tick_if_due();
    }
    count_inbox_drops();
    publish_status_if_due();
  }
  publish_poses(engine_.finish());
  map_publisher_.reset();
  journal_.reset();
  if (!options_.output_directory.empty()) write_results();
}

void LiveServer::handle(Message message) {
  message.utime = std::max(message.utime, last_utime_);
  const Decoded decoded = decode(engine_.configuration(), message.channel, message.bytes, message.utime);
  if (!decoded.ours) return;
  if (!decoded.event || is_own(*decoded.event)) {
    engine_.count_dropped(decoded.robot, decoded.event ? "bad_channel" : decoded.reason);
    return;
  }
  last_utime_ = message.utime;
  monitor_.heard(decoded.robot, message.utime);
  journal(message);
  take(*decoded.event);
  if (asks_for_map(*decoded.event)) map_publisher_->request_whole();
}

void LiveServer::take(const Event& event) {
  const Clock::time_point start = Clock::now();
  const Outcome outcome = engine_.handle(event);
  last_event_ = Clock::now();
  latency_.add(seconds(last_event_ - start));
  publish_poses(outcome);
}

void LiveServer::journal(const Message& message) {
  if (journal_) journal_->append(message);
}

void LiveServer::publish_poses(const Outcome& outcome) {
  for (const RobotPose& pose : outcome.poses) {
    monitor_.answered(pose);
    publish_(pose.robot + "_POSE", encoded(pose_message(pose)));
  }
}

void LiveServer::tick_if_due() {
  if (!options_.clock || !engine_.has_queued_work()) return;
  if (Clock::now() - last_event_ < options_.tick_interval) return;
  last_utime_ = std::max(last_utime_, options_.clock());
  const Event tick{last_utime_, TickEvent{}};
  journal(encode(tick));
  take(tick);
}

void LiveServer::count_inbox_drops() {
  for (const auto& [robot, reasons] : inbox_.take_drops()) {
    for (const auto& [reason, count] : reasons) {
      for (std::int64_t i = 0; i < count; ++i) engine_.count_dropped(robot, reason);
    }
  }
}

void LiveServer::publish_status_if_due() {
  const Clock::duration elapsed = Clock::now() - last_status_;
  if (elapsed < options_.status_interval) return;
  last_status_ += elapsed;
  const auto map = std::make_shared<const MapCopy>(engine_.copy());
  const ServerCounters server{static_cast<std::int32_t>(inbox_.size()), journal_ ? journal_->bytes() : 0,
                              journal_ ? journal_->failures() : 0};
  const std::int64_t utime = options_.clock ? options_.clock() : last_utime_;
  publish_("ISTHMUS_STATUS", encoded(monitor_.status(*map, server, utime, seconds(elapsed))));
  if (const auto rendezvous = rendezvous_.due(*map, utime, last_status_))
    publish_("ISTHMUS_RENDEZVOUS", encoded(*rendezvous));
  map_publisher_->offer(map, utime);
}

void LiveServer::write_results() {
  RunCost cost;
  cost.wall_s = seconds(Clock::now() - start_);
  cost.cpu_s = process_cpu_s();
  cost.peak_rss_mb = process_peak_rss_mb();
  cost.event_latency = latency_;
  write_outputs(engine_.copy(), cost, options_.output_directory);
}

}  // namespace isthmus
