#include <benchmark/benchmark.h>
#include <unistd.h>

#include <atomic>
#include <ctime>
#include <filesystem>
#include <lcm/lcm-cpp.hpp>
#include <string>
#include <thread>

#include "server/wire/intake/inbox.hpp"
#include "server/wire/intake/spool.hpp"
#include "server/wire/journal/event_log.hpp"
#include "server/wire/journal/journal.hpp"
#include "server/wire/message/message.hpp"
#include "server/wire/network/udp_receiver.hpp"
#include "server/wire/trust/authenticator.hpp"
#include "server/wire/trust/envelope.hpp"
#include "tests/support/lcm_datagrams.hpp"

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

std::vector<Bytes> datagrams_of(std::uint32_t sequence, const Bytes& message) {
  constexpr std::size_t fragment_bytes = 65'487;  // liblcm's
  if (message.size() < fragment_bytes) return {short_datagram(sequence, "R1_SCAN", message)};
  return fragment_datagrams(sequence, "R1_SCAN", message, fragment_bytes);
}

double cpu_s(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Counts what UdpReceiver hears, in a thread of its own.
class OwnReceiver {
 public:
  OwnReceiver() : receiver_(parse_udp_url(test_udp_url())) {
    thread_ = std::jthread([this](const std::stop_token& stop) {
      Reassembly messages(
          {[](std::string_view) { return true; }, [this](auto, auto, auto) { ++heard_; }, [](auto, auto) {}});
      while (!stop.stop_requested()) receiver_.receive(std::chrono::milliseconds(100), messages);
    });
  }
  bool good() const { return true; }
  std::int64_t heard() const { return heard_; }

 private:
  UdpReceiver receiver_;
  std::atomic<std::int64_t> heard_ = 0;
  std::jthread thread_;
};

/// Counts what liblcm hears, in a thread of its own beside liblcm's.
class LiblcmReceiver {
 public:
  LiblcmReceiver() : lcm_(test_udp_url()) {
    if (!lcm_.good()) return;
    lcm_.subscribe("R1_SCAN", &LiblcmReceiver::take, this)->setQueueCapacity(4000);
    thread_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) lcm_.handleTimeout(100);
    });
  }
  bool good() const { return lcm_.good(); }
  std::int64_t heard() const { return heard_; }

 private:
  void take(const lcm::ReceiveBuffer*, const std::string&) { ++heard_; }

  lcm::LCM lcm_;
  std::atomic<std::int64_t> heard_ = 0;
  std::jthread thread_;
};

/// Channel, byte check, generated decoder and value checks.
void decode_scan(benchmark::State& state) {
  const Message message = scan_message(static_cast<std::size_t>(state.range(0)));
  const ChannelNames configured;
  for (auto _ : state) {
    benchmark::DoNotOptimize(decode(configured, message.channel, message.bytes, message.utime));
  }
}
BENCHMARK(decode_scan)->Arg(180)->Arg(1081);

void refuse_scan_of_wrong_length(benchmark::State& state) {
  Message message = scan_message(1081);
  message.bytes.pop_back();
  const ChannelNames configured;
  for (auto _ : state) {
    benchmark::DoNotOptimize(decode(configured, message.channel, message.bytes, message.utime));
  }
}
BENCHMARK(refuse_scan_of_wrong_length);

/// What keeping a received message on the disk costs: written, and settled later. Syncing is another
/// thread's.
void spool_scan(benchmark::State& state) {
  const std::string directory = scratch("isthmus-bench-spool");
  std::filesystem::create_directory(directory);
  const Message scan = scan_message(static_cast<std::size_t>(state.range(0)));
  {
    Spool spool(directory, {});
    for (auto _ : state) {
      Message message = scan;
      spool.append(message, true);
      spool.settle(message.received - 1000);
    }
  }
  std::filesystem::remove_all(directory);
}
BENCHMARK(spool_scan)->Arg(180)->Arg(1081);

/// An envelope checked, opened and believed; its counter grows by a change of the message that is summed.
void open_envelope(benchmark::State& state) {
  const Message message = scan_message(static_cast<std::size_t>(state.range(0)));
  const AuthKey key = {1, 2, 3};
  Authentication keys;
  keys.robots["R1"] = key;
  Authenticator authenticator(keys);
  const ChannelNames configured;
  std::int64_t counter = 0;
  for (auto _ : state) {
    state.PauseTiming();
    const Message sealed = seal(key, "R1", ++counter, message);
    state.ResumeTiming();
    Opened opened = authenticator.open(configured, 1, sealed.bytes);
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
  const ChannelNames configured;
  for (auto _ : state) benchmark::DoNotOptimize(authenticator.open(configured, 1, sealed.bytes));
}
BENCHMARK(refuse_forgery)->Arg(180)->Arg(1081);

/// A scan's datagrams by the server's own receiver: one for 1081 beams, 17 for a message of a megabyte.
void take_datagrams(benchmark::State& state) {
  const Bytes message(static_cast<std::size_t>(state.range(0)), 7);
  std::uint32_t sequence = 0;
  std::int64_t delivered = 0;
  Reassembly reassembly(
      {[](std::string_view) { return true; },
       [&](auto, auto, auto bytes) { delivered += static_cast<std::int64_t>(bytes.size()); },
       [](auto, auto) {}});
  for (auto _ : state) {
    state.PauseTiming();
    const std::vector<Bytes> datagrams = datagrams_of(++sequence, message);
    state.ResumeTiming();
    for (const Bytes& datagram : datagrams) reassembly.take({1, 2}, datagram, 1, 1);
  }
  if (delivered != state.iterations() * state.range(0)) state.SkipWithError("lost");
}
BENCHMARK(take_datagrams)->Arg(4400)->Arg(1'000'000);

/// From the network to the handler, in threads as a server has them; what the sending takes is not counted.
/// CPU time of the process less that of the sending thread, for each message.
template <class Receiver>
void receive_udp(benchmark::State& state) {
  const Bytes message(static_cast<std::size_t>(state.range(0)), 7);
  Receiver receiver;
  if (!receiver.good()) return state.SkipWithError("no multicast route on this machine");
  const DatagramSender sender;
  std::uint32_t sequence = 0;
  for (auto _ : state) {
    const double begin_s = cpu_s(CLOCK_PROCESS_CPUTIME_ID) - cpu_s(CLOCK_THREAD_CPUTIME_ID);
    const std::int64_t heard = receiver.heard();
    constexpr int burst = 20;  // which every receive buffer holds
    for (int i = 0; i < burst; ++i)
      for (const Bytes& datagram : datagrams_of(++sequence, message)) sender.send(datagram);
    while (receiver.heard() < heard + burst) std::this_thread::sleep_for(std::chrono::microseconds(100));
    const double end_s = cpu_s(CLOCK_PROCESS_CPUTIME_ID) - cpu_s(CLOCK_THREAD_CPUTIME_ID);
    state.SetIterationTime((end_s - begin_s) / burst);
  }
}
BENCHMARK(receive_udp<OwnReceiver>)->Arg(800)->Arg(4400)->Arg(150'000)->UseManualTime()->Iterations(1000);
BENCHMARK(receive_udp<LiblcmReceiver>)->Arg(800)->Arg(4400)->Arg(150'000)->UseManualTime()->Iterations(1000);

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

/// The same of a journal, every event verified.
void read_journal_event(benchmark::State& state) {
  const std::string directory = scratch("isthmus-bench-journal-");
  {
    Journal journal(directory);
    for (int i = 0; i < 10'000; ++i) journal.append(scan_message(1081));
  }
  for (auto _ : state) {
    EventLogReader reader(directory);
    while (auto message = reader.next()) benchmark::DoNotOptimize(message);
  }
  state.SetItemsProcessed(state.iterations() * 10'000);
  std::filesystem::remove_all(directory);
}
BENCHMARK(read_journal_event)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace isthmus
