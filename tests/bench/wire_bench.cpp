#include <benchmark/benchmark.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "server/wire/event_log.hpp"
#include "server/wire/inbox.hpp"
#include "server/wire/journal.hpp"
#include "server/wire/message.hpp"

namespace isthmus {
namespace {

Message scan_message(std::size_t beams) {
  ScanEvent event{"R1", {1'000'000, -1.5, 3.0 / static_cast<double>(beams), std::vector<float>(beams, 5.0F)}};
  return encode({1'000'000, event});
}

std::string scratch(const std::string& name) {
  const auto path = std::filesystem::temp_directory_path() / (name + std::to_string(getpid()));
  std::filesystem::remove_all(path);
  return path.string();
}

/// Channel, byte check, generated decoder and value checks.
void decode_scan(benchmark::State& state) {
  const Message message = scan_message(static_cast<std::size_t>(state.range(0)));
  const Configuration configuration;
  for (auto _ : state) {
    benchmark::DoNotOptimize(decode(configuration, message.channel, message.bytes, message.utime));
  }
}
BENCHMARK(decode_scan)->Arg(180)->Arg(1081);

void refuse_scan_of_wrong_length(benchmark::State& state) {
  Message message = scan_message(1081);
  message.bytes.pop_back();
  const Configuration configuration;
  for (auto _ : state) {
    benchmark::DoNotOptimize(decode(configuration, message.channel, message.bytes, message.utime));
  }
}
BENCHMARK(refuse_scan_of_wrong_length);

void push_and_pop(benchmark::State& state) {
  const Message message = scan_message(1081);
  Inbox inbox;
  for (auto _ : state) {
    inbox.push("R1", true, message.utime, message.channel, message.bytes);
    benchmark::DoNotOptimize(inbox.pop(std::chrono::milliseconds(0)));
  }
}
BENCHMARK(push_and_pop);

void append_to_journal(benchmark::State& state) {
  const Message message = scan_message(1081);
  const std::string directory = scratch("isthmus-bench-journal-");
  {
    Journal journal(directory, message);
    for (auto _ : state) benchmark::DoNotOptimize(journal.append(message));
  }
  std::filesystem::remove_all(directory);
}
BENCHMARK(append_to_journal)->Iterations(20'000);

void read_log_event(benchmark::State& state) {
  const std::string path = scratch("isthmus-bench-log-");
  EventLogWriter writer(path);
  for (int i = 0; i < 10'000; ++i) writer.write(scan_message(1081));
  writer.finish();
  for (auto _ : state) {
    EventLogReader reader(path);
    while (auto message = reader.next()) benchmark::DoNotOptimize(message);
  }
  state.SetItemsProcessed(state.iterations() * 10'000);
  std::filesystem::remove(path);
}
BENCHMARK(read_log_event)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace isthmus
