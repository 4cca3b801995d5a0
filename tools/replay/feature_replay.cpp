#include "tools/replay/feature_replay.hpp"

#include <chrono>

#include "server/wire/file/text_file.hpp"
#include "server/wire/journal/drop_record.hpp"
#include "server/wire/journal/event_log.hpp"
#include "server/wire/journal/snapshot.hpp"
#include "server/wire/message/message.hpp"
#include "tools/replay/replay.hpp"
#include "tools/text/printed.hpp"

namespace isthmus {
namespace {

using Clock = std::chrono::steady_clock;

void read(const std::string& path, const FeatureReplayOptions& options, FeatureEstimator& estimator) {
  EventLogReader reader(whole_log(path));
  ChannelNames channels;
  std::optional<std::int64_t> first_utime;
  while (const std::optional<Message> message = reader.next()) {
    if (const std::optional<Drops> drops = read_drops(*message)) {
      count_drops(estimator, *drops);
      continue;
    }
    const Decoded decoded = decode(channels, message->channel, message->bytes, message->utime);
    if (decoded.ours && !decoded.event) estimator.count_dropped(decoded.robot, decoded.reason, 1);
    if (!decoded.event) continue;
    if (!first_utime) first_utime = message->utime;
    if (1e-6 * static_cast<double>(message->utime - *first_utime) > options.until_s) break;
    if (const auto* configuration = std::get_if<ConfigurationEvent>(&decoded.event->body))
      channels = parse_server_configuration(configuration->toml, reader.file()).channels;
    estimator.handle(*decoded.event);
    if (options.progress) options.progress(reader.progress());
  }
  Outcome outcome;
  estimator.finish_step(outcome);
  for (const std::string& warning : reader.take_warnings())
    if (options.warn) options.warn(warning);
}

}  // namespace

std::optional<FeatureMapKind> feature_kind_of(const std::string& path, const std::string& config_file) {
  if (!config_file.empty())
    return feature_kind(parse_server_configuration(read_text_file(config_file), config_file).estimator);
  const std::optional<Message> first = EventLogReader(whole_log(path)).next();
  if (!first) return std::nullopt;
  const Decoded decoded = decode({}, first->channel, first->bytes, first->utime);
  const auto* event = decoded.event ? std::get_if<ConfigurationEvent>(&decoded.event->body) : nullptr;
  if (event == nullptr) return std::nullopt;
  return feature_kind(parse_server_configuration(event->toml, path + ": its configuration").estimator);
}

FeatureReplayResult replay_features(const std::string& path, const FeatureReplayOptions& options) {
  const Clock::time_point start = Clock::now();
  const double cpu_start_s = process_cpu_s();
  FeatureEstimator estimator(options.map);
  estimator.forbid(options.forbid);
  read(path, options, estimator);
  FeatureReplayResult result;
  result.maps = estimator.maps();
  result.cost.wall_s = seconds_of(Clock::now() - start);
  result.cost.cpu_s = process_cpu_s() - cpu_start_s;
  result.cost.peak_rss_mb = process_peak_rss_mb();
  return result;
}

std::string summary_text(const FeatureReplayResult& result) {
  const FeatureCounts& counts = result.maps.counts;
  std::size_t features = 0;
  for (const Team& team : result.maps.teams) features += team.filter.state().features.size();
  const double log_s = 1e-6 * static_cast<double>(counts.last_receive_utime - counts.first_receive_utime);
  std::string text = printed_line("scans      %lld, %lld used", static_cast<long long>(counts.scans),
                                  static_cast<long long>(counts.scans_used));
  text += printed_line("map        %zu features, %zu islands, %lld fusions, %lld withdrawn", features,
                       result.maps.teams.size(), static_cast<long long>(counts.fusions),
                       static_cast<long long>(counts.withdrawn));
  text += printed_line("segments   %lld seen, %lld paired", static_cast<long long>(counts.segments_seen),
                       static_cast<long long>(counts.segments_paired));
  text += printed_line("time       %.1f s of log in %.2f s, %.2f s CPU; peak memory %.0f MB", log_s,
                       result.cost.wall_s, result.cost.cpu_s, result.cost.peak_rss_mb);
  return text + "map_sha256 " + map_sha256(result.maps) + "\n";
}

}  // namespace isthmus
