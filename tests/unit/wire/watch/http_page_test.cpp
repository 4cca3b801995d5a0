#include "server/wire/watch/http_page.hpp"

// Before httplib.h, also for the files that follow in a unity build: see there.
#include <Eigen/Core>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <filesystem>
#include <optional>
#include <vector>

#include "server/wire/watch/http_connection.hpp"
#include "tests/support/descriptor_limit.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/waiting.hpp"

// Last: the system's headers that it brings define _res, which Eigen has for a name.
#include <httplib.h>

namespace isthmus {
namespace {

using namespace std::chrono_literals;

std::string more_than_sockets_hold() {
  std::string text;
  text.resize(20'000'000, 'x');
  return text;
}
using Clock = std::chrono::steady_clock;

TEST(HttpRequest, IsItsFirstLine) {
  const auto parse = [](std::string_view head) {
    const HttpRequest request = parse_http_request(head);
    return std::string(request.method) + "|" + std::string(request.path);
  };
  EXPECT_EQ(parse("GET /metrics HTTP/1.1\r\nHost: x\r\n\r\n"), "GET|/metrics");
  EXPECT_EQ(parse("GET /metrics?a=b HTTP/1.0\r\n\r\n"), "GET|/metrics");
  for (const char* head :
       {"", "GET", "GET /", "GET HTTP/1.1", "GET / HTTP/2", "\r\n\r\n", "  ", " / HTTP/1.1"})
    EXPECT_TRUE(parse_http_request(head).method.empty()) << head;
}

/// A client's end of a connection.
class HttpClient {
 public:
  explicit HttpClient(const HttpPage& page) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(page.port()));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = ::connect(socket_.get(), reinterpret_cast<sockaddr*>(&to), sizeof to) == 0;
  }
  bool connected() const { return connected_; }
  bool send(const std::string& text) const {
    return ::send(socket_.get(), text.data(), text.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(text.size());
  }
  /// Whether the server has ended the connection by `deadline`; what it said before is skipped.
  bool is_closed(Clock::time_point deadline) const {
    std::array<char, 4096> bytes;
    while (true) {
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
      const timeval wait{left > 0 ? left / 1000 : 0, left > 0 ? left % 1000 * 1000 : 1};
      ::setsockopt(socket_.get(), SOL_SOCKET, SO_RCVTIMEO, &wait, sizeof wait);
      const ssize_t size = ::recv(socket_.get(), bytes.data(), bytes.size(), 0);
      if (size == 0 || (size < 0 && errno == ECONNRESET)) return true;
      if (size < 0) return false;
    }
  }

 private:
  FileHandle socket_;
  bool connected_ = false;
};

/// So long that a busy machine does not end an exchange in a test.
HttpLimits patient() {
  HttpLimits limits;
  limits.exchange_time = 60s;
  return limits;
}

HttpPage page_of(HttpLimits limits = patient()) { return HttpPage(0, "/metrics", "text/plain", limits); }

/// The page's text, or why there is none.
std::string scrape(const HttpPage& page) {
  httplib::Client client("127.0.0.1", page.port());
  client.set_connection_timeout(60s);
  client.set_read_timeout(60s);
  const auto answer = client.Get("/metrics");
  return answer ? answer->body : httplib::to_string(answer.error());
}

TEST(HttpPage, IsServedToThisMachine) {
  HttpPage page(0, "/metrics", "text/plain; version=0.0.4");
  page.set("isthmus_events_total 1\n");
  httplib::Client client("127.0.0.1", page.port());
  for (const char* path : {"/metrics", "/metrics?x=1"}) {
    const auto answer = client.Get(path);
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->status, 200);
    EXPECT_EQ(answer->body, "isthmus_events_total 1\n");
    EXPECT_EQ(answer->get_header_value("Content-Type"), "text/plain; version=0.0.4");
  }
  EXPECT_EQ(client.Head("/metrics")->get_header_value("Content-Length"), "23");
  EXPECT_EQ(client.Get("/")->status, 404);
  EXPECT_EQ(client.Delete("/metrics")->status, 405);
}

TEST(HttpPage, IsServedWholeHoweverLong) {
  HttpPage page = page_of();
  const std::string text = more_than_sockets_hold();
  page.set(text);
  EXPECT_EQ(scrape(page), text);
}

TEST(HttpPage, SaysWhereItsPortIsTaken) {
  const HttpPage page = page_of();
  EXPECT_EQ(error_of([&] { HttpPage again(page.port(), "/", "text/plain"); }),
            "port " + std::to_string(page.port()) + " of 127.0.0.1 cannot be had: Address already in use");
}

TEST(HttpPage, IsServedBesideASlowRequest) {
  HttpPage page = page_of();
  page.set("text");
  const HttpClient slow(page);
  ASSERT_TRUE(slow.send("GET /metr"));
  const auto start = Clock::now();
  EXPECT_EQ(scrape(page), "text");
  EXPECT_LT(Clock::now() - start, patient().exchange_time / 2) << "waits for none of them";
}

// A byte now and then holds the connection no longer than its time.
TEST(HttpPage, EndsARequestThatDribbles) {
  HttpLimits limits;
  limits.exchange_time = 300ms;
  HttpPage page = page_of(limits);
  const auto start = Clock::now();
  const HttpClient slow(page);
  while (slow.send("x") && !slow.is_closed(Clock::now() + 20ms) && Clock::now() < start + 10s) {
  }
  EXPECT_TRUE(slow.is_closed(start + 10s));
  EXPECT_GE(Clock::now() - start, 300ms);
}

TEST(HttpPage, EndsARequestThatIsTooLong) {
  HttpPage page = page_of();
  const HttpClient client(page);
  client.send("GET /" + std::string(100'000, 'x'));
  EXPECT_TRUE(client.is_closed(Clock::now() + patient().exchange_time / 2));
}

std::ptrdiff_t open_descriptors() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {});
}

// The answer is longer than the sockets' buffers; the server's end is closed though nobody reads.
TEST(HttpPage, EndsAnAnswerThatNobodyReads) {
  HttpLimits limits;
  limits.exchange_time = 2s;
  HttpPage page = page_of(limits);
  page.set(more_than_sockets_hold());
  const std::ptrdiff_t before = open_descriptors();
  const HttpClient idle(page);
  ASSERT_TRUE(idle.send("GET /metrics HTTP/1.1\r\n\r\n"));
  EXPECT_TRUE(happens([&] { return open_descriptors() == before + 2; }));
  EXPECT_TRUE(happens([&] { return open_descriptors() == before + 1; }));
}

TEST(HttpPage, IsServedBesideAThousandIdleConnectionsAndKeepsFewOfThem) {
  const DescriptorLimit limit(4096);
  HttpPage page = page_of();
  page.set("text");
  std::vector<HttpClient> idle;
  for (int i = 0; i < 1000; ++i) ASSERT_TRUE(idle.emplace_back(page).connected()) << i;
  const auto start = Clock::now();
  EXPECT_EQ(scrape(page), "text");
  EXPECT_LT(Clock::now() - start, patient().exchange_time / 2);
  std::size_t open = idle.size();
  for (const HttpClient& client : idle) open -= client.is_closed(Clock::now() + 1ms) ? 1 : 0;
  EXPECT_LE(open, HttpLimits().connections);
}

TEST(HttpPage, IsServedAgainOnceThereAreDescriptors) {
  HttpPage page = page_of();
  page.set("text");
  std::optional<HttpClient> first;
  {
    const DescriptorLimit limit(next_descriptor() + 1);  // for the client's end, and none for the server's
    first.emplace(page);
    ASSERT_TRUE(first->send("GET /metrics HTTP/1.1\r\n\r\n"));
    EXPECT_FALSE(first->is_closed(Clock::now() + 300ms));
  }
  EXPECT_TRUE(first->is_closed(Clock::now() + patient().exchange_time / 2)) << "answered";
  EXPECT_EQ(scrape(page), "text");
}

TEST(HttpPage, EndsAtOnceWithConnectionsOpen) {
  std::vector<HttpClient> clients;
  Clock::time_point start;
  {
    HttpPage page = page_of();
    page.set(more_than_sockets_hold());
    for (int i = 0; i < 30; ++i) {
      clients.emplace_back(page).send(i % 2 == 0 ? "GET /metr" : "GET /metrics HTTP/1.1\r\n\r\n");
    }
    start = Clock::now();
  }
  EXPECT_LT(Clock::now() - start, patient().exchange_time / 2) << "waits for none of them";
}

}  // namespace
}  // namespace isthmus
