#include <benchmark/benchmark.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "server/wire/authenticator.hpp"
#include "server/wire/envelope.hpp"
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

/// An envelope checked, opened and believed; its counter grows by a change of the message that is summed.
void open_envelope(benchmark::State& state) {
  const Message message = scan_message(static_cast<std::size_t>(state.range(0)));
  const AuthKey key = {1, 2, 3};
  Authentication keys;
  keys.robots["R1"] = key;
  Authenticator authenticator(keys);
  const Configuration configuration;
  std::int64_t counter = 0;
  for (auto _ : state) {
    state.PauseTiming();
    const Message sealed = seal(key, "R1", ++counter, message);
    state.ResumeTiming();
    Opened opened = authenticator.open(configuration, 1, sealed.bytes);
    if (!opened.message) state.SkipWithError("refused");
    benchmark::DoNotOptimize(opened);
  }
}
BENCHMARK(open_envelope)->Arg(180)->Arg(1081);

void seal_envelope(benchmark::State& state) {
  const Message message = scan_message(static_cast<std::size_t>(state.range(0)));
  const AuthKey key = {1, 2, 3};
  std::int64_t counter = 0;
  for (auto _ : state) benchmark::DoNotOptimize(seal(key, "R1", ++counter, message));
}
BENCHMARK(seal_envelope)->Arg(180)->Arg(1081);

void refuse_forgery(benchmark::State& state) {
  const Message sealed = seal({4, 5, 6}, "R1", 1, scan_message(static_cast<std::size_t>(state.range(0))));
  Authentication keys;
  keys.robots["R1"] = {1, 2, 3};
  Authenticator authenticator(keys);
  const Configuration configuration;
  for (auto _ : state) benchmark::DoNotOptimize(authenticator.open(configuration, 1, sealed.bytes));
}
BENCHMARK(refuse_forgery)->Arg(180)->Arg(1081);

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
    Journal journal(directory);
    for (auto _ : state) benchmark::DoNotOptimize(journal.append(message));
  }
  std::filesystem::remove_all(directory);
}
BENCHMARK(append_to_journal)->Iterations(20'000);

/// The same with what a restart must know of its signature.
void append_signed_to_journal(benchmark::State& state) {
  Message message = scan_message(1081);
  message.signature = Signature{"R1", "R1_SCAN", 0};
  const std::string directory = scratch("isthmus-bench-journal-");
  {
    Journal journal(directory);
    journal.count_signatures();
    for (auto _ : state) {
      message.signature->counter += 1;
      benchmark::DoNotOptimize(journal.append(message));
    }
  }
  std::filesystem::remove_all(directory);
}
BENCHMARK(append_signed_to_journal)->Iterations(20'000);

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
