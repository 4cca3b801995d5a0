#include "tools/simulate/campaigns/hostile/hostile.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include "server/output/output.hpp"
#include "server/wire/live/live_server.hpp"
#include "tools/simulate/campaigns/confidence/confidence.hpp"
#include "tools/simulate/campaigns/hostile/unruly_messages.hpp"
#include "tools/simulate/plan/random.hpp"

namespace isthmus {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr const char* intruder = "INTRUDER";
constexpr std::size_t longest_bytes = 20'000;
constexpr double unruly_share = 0.1;

void put_number(Bytes& bytes, Random& random) {
  static constexpr std::array numbers = {
      std::bit_cast<std::uint64_t>(std::numeric_limits<double>::quiet_NaN()),
      std::bit_cast<std::uint64_t>(std::numeric_limits<double>::infinity()),
      std::bit_cast<std::uint64_t>(-1e300),
      std::bit_cast<std::uint64_t>(1e-310),
      std::uint64_t{0},
      ~std::uint64_t{0},
      std::uint64_t{1} << 63,
      std::uint64_t{0x7fffffff7fffffff}};
  const std::uint64_t number = numbers[random.index(numbers.size())];
  const std::size_t width = random.chance(0.5) ? 4 : 8;
  const std::size_t at = random.index(bytes.size());
  for (std::size_t i = 0; i < width && at + i < bytes.size(); ++i)
    bytes[at + i] = static_cast<std::uint8_t>(number >> (56 - 8 * i));
}

void splice(Bytes& bytes, const Bytes& other, Random& random) {
  const std::size_t keep = random.index(bytes.size() + 1);
  const std::size_t from = random.index(other.size() + 1);
  bytes.resize(keep);
  bytes.insert(bytes.end(), other.begin() + static_cast<std::ptrdiff_t>(from), other.end());
}

/// A message with one or a few things wrong with it.
Bytes spoilt(Bytes bytes, const Bytes& other, Random& random) {
  const auto byte = [&] { return static_cast<std::uint8_t>(random.index(256)); };
  for (std::size_t change = 0; change <= random.index(4) && !bytes.empty(); ++change) {
    switch (random.index(7)) {
      case 0:
        for (std::size_t flips = 0; flips <= random.index(8); ++flips)
          bytes[random.index(bytes.size())] ^= static_cast<std::uint8_t>(1U << random.index(8));
        break;
      case 1:
        bytes[random.index(bytes.size())] = byte();
        break;
      case 2:
        bytes.resize(random.index(bytes.size() + 1));
        break;
      case 3:
        bytes.resize(std::min(longest_bytes, bytes.size() + random.index(200)), byte());
        break;
      case 4:
        put_number(bytes, random);
        break;
      case 5:
        splice(bytes, other, random);
        break;
      case 6:
        std::ranges::generate(bytes, byte);
        break;
      default:
        break;
    }
  }
  return bytes;
}

/// In whose name: the intruder's own kind of channel most of the time.
std::string hostile_channel(const std::string& genuine, Random& random) {
  static constexpr std::array own = {
      "ISTHMUS_TAG", "ISTHMUS_CONFIGURATION", "ISTHMUS_TICK", "ISTHMUS_SIGNED", "ISTHMUS_MAP", "_SCAN", "",
      "SCAN"};
  const std::string kind = genuine.substr(genuine.find_last_of('_') + 1);
  if (random.chance(0.1)) return own[random.index(own.size())];
  if (random.chance(0.1)) return "STRANGER" + std::to_string(random.index(1'000'000)) + "_" + kind;
  static constexpr std::array kinds = {"ROBOT", "ODOMETRY", "SCAN", "SIGHTING"};
  return std::string(intruder) + "_" + (random.chance(0.1) ? kinds[random.index(kinds.size())] : kind);
}

std::string sender_of(const Message& message) { return message.channel.substr(0, message.channel.find('_')); }

/// Who may be named by what is well formed.
Unruly unruly_one(const std::vector<Message>& team, HostileNames names) {
  Unruly unruly;
  unruly.robots = {intruder};
  if (names == HostileNames::intruder) return unruly;
  std::set<std::string> robots;
  std::set<std::int32_t> barcodes;
  for (const Message& message : team) {
    const auto event = decode(ChannelNames{}, message.channel, message.bytes, message.utime).event;
    if (!event) continue;
    if (const auto* robot = std::get_if<RobotEvent>(&event->body)) {
      robots.insert(robot->robot);
      barcodes.insert(robot->barcode);
    }
    if (const auto* sighting = std::get_if<SightingEvent>(&event->body)) barcodes.insert(sighting->barcode);
  }
  barcodes.erase(-1);
  unruly.robots.insert(unruly.robots.end(), robots.begin(), robots.end());
  unruly.barcodes.assign(barcodes.begin(), barcodes.end());
  unruly.closures = 100;
  return unruly;
}

/// The team's messages, and so many hostile ones between them.
void send(const std::vector<Message>& team, std::int64_t hostile, std::uint64_t seed, HostileNames names,
          Inbox& inbox) {
  Random random(seed, "hostile");
  Unruly unruly = unruly_one(team, names);
  std::int64_t sent = 0;
  const auto push = [&](const Message& message) {
    inbox.push_waiting(sender_of(message), message.channel.ends_with("_SCAN"), message.utime, message.channel,
                       message.bytes);
  };
  RobotEvent introduction;
  introduction.robot = intruder;
  introduction.laser.range_max_m = 30;
  if (hostile > 0) push(encode({team.front().utime, introduction}));
  for (std::size_t i = 0; i < team.size(); ++i) {
    push(team[i]);
    const auto due = static_cast<std::int64_t>(i + 1) * hostile / static_cast<std::int64_t>(team.size());
    for (; sent < due; ++sent) {
      if (random.chance(unruly_share)) {
        unruly.robot = unruly.robots[random.index(unruly.robots.size())];
        push(encode(unruly_event(unruly, team[i].utime, random)));
        continue;
      }
      const Message& genuine = team[random.index(i + 1)];
      const Bytes& other = team[random.index(i + 1)].bytes;
      push({team[i].utime, hostile_channel(genuine.channel, random), spoilt(genuine.bytes, other, random)});
    }
  }
  inbox.close();
}

MapCopy serve(const std::vector<Message>& team, std::int64_t hostile, std::uint64_t seed,
              HostileNames names) {
  Inbox inbox({}, InboxOrder::arrival);
  LiveOptions options;
  options.start_utime = team.front().utime;
  LiveServer server(options, inbox, [](const auto&, const auto&) {});
  std::jthread sender([&] { send(team, hostile, seed, names, inbox); });
  server.run();
  return server.engine().copy();
}

}  // namespace

HostileTrial try_hostile_messages(const Scenario& scenario, std::uint64_t seed, std::int64_t messages,
                                  HostileNames names) {
  const SimulatedRun run = simulate(scenario, seed);
  std::vector<Message> team;
  for (const Event& event : run.events)
    if (!std::holds_alternative<ConfigurationEvent>(event.body)) team.push_back(encode(event));
  HostileTrial trial;
  trial.messages = messages;
  const double cpu_s = process_cpu_s();
  const MapCopy map = serve(team, messages, seed, names);
  trial.cpu_s = process_cpu_s() - cpu_s;
  trial.peak_rss_mb = process_peak_rss_mb();
  const MapCopy clean = serve(team, 0, seed, names);
  trial.dropped = map.counters.dropped;
  if (clean.counters.events > map.counters.events)
    throw std::runtime_error("the server took fewer events with the hostile messages than without");
  trial.hostile_patches = static_cast<std::size_t>(std::ranges::count(
      map.patches, std::string(intruder), [](const PatchPtr& patch) { return patch->robot; }));
  trial.errors = compare(sample_relations(run.truth, seed), map, clean);
  return trial;
}

}  // namespace isthmus
