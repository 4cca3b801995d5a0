#include "server/wire/page/page_server.hpp"

#include <httplib.h>
#include <zlib.h>

#include <array>
#include <atomic>
#include <charconv>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>

#include "isthmus/annotation_t.hpp"
#include "isthmus/command_t.hpp"
#include "isthmus/initial_pose_t.hpp"
#include "isthmus/signed_t.hpp"
#include "server/wire/page/asset.hpp"
#include "server/wire/page/connection_pool.hpp"
#include "server/wire/page/download.hpp"
#include "server/wire/page/preview.hpp"

namespace isthmus {
namespace {

using httplib::Request;
using httplib::Response;
using Json = nlohmann::json;
using Text = std::shared_ptr<const std::string>;

constexpr const char* json_type = "application/json";
constexpr const char* forever = "private, max-age=31536000, immutable";
constexpr std::size_t largest_order = 65'536;

/// The rest of the page must come from here, and nobody may put it into a page of theirs.
const httplib::Headers safe_headers = {
    {"Content-Security-Policy",
     "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src "
     "'self'; form-action 'self'; frame-ancestors 'none'; base-uri 'none'"},
    {"X-Content-Type-Options", "nosniff"},
    {"Referrer-Policy", "no-referrer"}};

/// httplib compresses what it is given whole, anew for each request, and some slowly: given piece by piece it
/// is sent as it is.
void answer(Response& response, const Text& bytes, const std::string& type) {
  response.set_header("Cache-Control", "no-store");
  if (bytes->empty()) return;
  response.set_content_provider(bytes->size(), type,
                                [bytes](std::size_t offset, std::size_t size, httplib::DataSink& sink) {
                                  return sink.write(bytes->data() + offset, size);
                                });
}

void answer(Response& response, int status, const Json& json) {
  response.status = status;
  answer(response, std::make_shared<const std::string>(json.dump()), json_type);
}

void refuse(Response& response, int status, const std::string& why) {
  answer(response, status, {{"error", why}});
}

void keep_forever(Response& response) {
  response.headers.erase("Cache-Control");
  response.set_header("Cache-Control", forever);
}

Text deflated(const std::string& bytes) {
  uLongf size = ::compressBound(static_cast<uLong>(bytes.size()));
  std::string packed(size, '\0');
  const auto* from = reinterpret_cast<const Bytef*>(bytes.data());
  if (::compress2(reinterpret_cast<Bytef*>(packed.data()), &size, from, static_cast<uLong>(bytes.size()),
                  Z_BEST_SPEED) != Z_OK)
    throw std::runtime_error("zlib has no memory");
  packed.resize(size);
  return std::make_shared<const std::string>(std::move(packed));
}

template <class Number>
bool read_number(std::string_view text, Number& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size();
}

/// "/tile/3/0/1/2" behind "/tile": 3, 0, 1, 2; fewer where one is no number.
std::vector<std::int32_t> numbers_behind(std::string_view path, std::string_view name) {
  std::vector<std::int32_t> numbers;
  path.remove_prefix(name.size());
  while (path.starts_with('/')) {
    path.remove_prefix(1);
    const std::string_view one = path.substr(0, path.find('/'));
    std::int32_t number = 0;
    if (!read_number(one, number)) return {};
    numbers.push_back(number);
    path.remove_prefix(one.size());
  }
  return numbers;
}

/// A version that a request names; 0: none.
std::int64_t version_of(const Request& request, const char* name) {
  std::int64_t version = 0;
  return read_number(request.get_param_value(name), version) ? version : 0;
}

std::string hexadecimal(std::int64_t fingerprint) {
  std::array<char, 16> digits;
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(),
                                          static_cast<std::uint64_t>(fingerprint), 16);
  return {digits.data(), end};
}

RequestOrigin origin_of(const Request& request) {
  return {request.get_header_value("Host"), request.get_header_value("Origin"),
          request.get_header_value("Cookie"), request.get_header_value("Authorization")};
}

/// The pool as httplib has it.
class Tasks : public httplib::TaskQueue {
 public:
  explicit Tasks(std::shared_ptr<ConnectionPool> pool) : pool_(std::move(pool)) {}
  void enqueue(std::function<void()> connection) override { pool_->add(std::move(connection)); }
  void shutdown() override { pool_->finish(); }

 private:
  std::shared_ptr<ConnectionPool> pool_;
};

}  // namespace

class PageServer::Site {
 public:
  Site(PageOptions options, TakeMessage take)
      : options_(std::move(options)),
        access_(options_.token),
        orders_(std::move(take), options_.order_time),
        pool_(std::make_shared<ConnectionPool>(options_.connections)) {
    if (!is_loopback(options_.address) && !access_.needs_token())
      throw std::runtime_error("a page that others can reach needs a token (--http-token-file)");
    set_limits();
    http_.set_default_headers(safe_headers);
    http_.set_pre_routing_handler([this](const Request& request, Response& response) {
      return route(request, response) ? httplib::Server::HandlerResponse::Handled
                                      : httplib::Server::HandlerResponse::Unhandled;
    });
    http_.Post("/command", [this](const Request& request, Response& response) { order(request, response); });
    listen();
    model_.bulletin().post("about", about());
    thread_ = std::jthread([this] { http_.listen_after_bind(); });
    while (!http_.is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }

  ~Site() {
    model_.bulletin().close();
    orders_.stop();
    pool_->stop();
    http_.stop();
    thread_.join();
  }

  int port() const { return port_; }
  PageModel& model() { return model_; }
  Orders& orders() { return orders_; }

 private:
  /// What a viewer needs to read all else.
  std::string about() const {
    const Json types = {{"command", hexadecimal(command_t::getHash())},
                        {"annotation", hexadecimal(annotation_t::getHash())},
                        {"initial_pose", hexadecimal(initial_pose_t::getHash())},
                        {"signed", hexadecimal(signed_t::getHash())}};
    return Json{{"run", model_.run()},      {"signed", options_.orders_signed},
                {"types", types},           {"cell_m", finest_cell_m},
                {"tile_cells", tile_cells}, {"coarsest_zoom", coarsest_zoom}}
        .dump();
  }

  void set_limits() {
    http_.set_read_timeout(options_.transfer_time);
    http_.set_write_timeout(options_.transfer_time);
    http_.set_keep_alive_timeout(1);
    http_.set_keep_alive_max_count(1000);
    http_.set_payload_max_length(largest_order);
    http_.set_tcp_nodelay(true);
    // A port that another server has is an error: httplib would share it.
    http_.set_socket_options([](socket_t socket) {
      const int yes = 1;
      ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    http_.new_task_queue = [this] { return new Tasks(pool_); };
  }

  void listen() {
    port_ = options_.port;
    const bool is_bound = port_ > 0 ? http_.bind_to_port(options_.address, port_)
                                    : (port_ = http_.bind_to_any_port(options_.address)) > 0;
    if (!is_bound)
      throw std::runtime_error("cannot serve a page at " + options_.address + ":" +
                               std::to_string(options_.port) + ": is the port taken?");
  }

  /// True: answered. What is posted must be read first.
  bool route(const Request& request, Response& response) {
    const RequestOrigin origin = origin_of(request);
    if (request.method == "POST" && request.path == "/command") {
      if (access_.may_order(origin)) return false;
      refuse(response, 403, "not from here");
      return true;
    }
    response.status = 200;
    if (request.method != "GET" && request.method != "HEAD") {
      refuse(response, 405, "method");
    } else if (request.path == "/" && request.has_param("token")) {
      enter(request, response);
    } else if (access_.may_see(origin)) {
      get(request, response);
    } else {
      turn_away(request, response);
    }
    return true;
  }

  void enter(const Request& request, Response& response) {
    const std::string token = request.get_param_value("token");
    if (!access_.is_token(token)) return turn_away(request, response);
    response.set_header("Set-Cookie",
                        std::string(token_cookie) + "=" + token + "; Path=/; HttpOnly; SameSite=Lax");
    response.set_redirect("/");
  }

  void turn_away(const Request& request, Response& response) const {
    if (!access_.needs_token()) return refuse(response, 403, "this page is served to this machine alone");
    if (request.path != "/" && request.path != "/token.css") return refuse(response, 401, "token");
    send_asset(request.path == "/" ? "/token.html" : request.path, response);
    if (request.path == "/") response.status = 401;
  }

  static void send_asset(const std::string& path, Response& response) {
    const Asset* asset = find_asset(path);
    if (!asset) return refuse(response, 404, "nothing here");
    answer(response, std::make_shared<const std::string>(asset->bytes), std::string(asset->content_type));
  }

  void get(const Request& request, Response& response) {
    const std::string& path = request.path;
    if (path == "/events") return events(response);
    if (path == "/preview") return preview(request, response);
    if (path.starts_with("/tiles/")) return tiles(request, numbers_behind(path, "/tiles"), response);
    if (path.starts_with("/tile/")) return tile(request, numbers_behind(path, "/tile"), response);
    if (path.starts_with("/patches/")) return patches(request, numbers_behind(path, "/patches"), response);
    if (path.starts_with("/download/")) return download(path, response);
    send_asset(path, response);
  }

  /// A viewer's place, until its stream ends.
  class Seat {
   public:
    explicit Seat(std::atomic<std::size_t>& taken) : taken_(taken) {}
    ~Seat() { taken_ -= 1; }
    Seat(const Seat&) = delete;
    Seat& operator=(const Seat&) = delete;

   private:
    std::atomic<std::size_t>& taken_;
  };

  void events(Response& response) {
    const std::size_t before = taken_seats_.fetch_add(1);
    const auto seat = std::make_shared<Seat>(taken_seats_);
    if (before >= options_.viewers) {
      response.set_header("Retry-After", "5");
      return refuse(response, 503, "there are as many viewers as there may be");
    }
    response.set_header("Cache-Control", "no-store");
    const auto cursor = std::make_shared<Bulletin::Cursor>();
    response.set_chunked_content_provider(
        "text/event-stream", [this, seat, cursor](std::size_t, httplib::DataSink& sink) {
          const std::optional<std::string> news = model_.bulletin().next(*cursor, options_.silence_time);
          if (!news) {
            sink.done();
            return true;
          }
          const std::string text = news->empty() ? ": nothing new\n\n" : *news;
          return sink.write(text.data(), text.size());
        });
  }

  void tiles(const Request& request, const std::vector<std::int32_t>& numbers, Response& response) {
    if (numbers.size() != 1) return refuse(response, 404, "/tiles/ISLAND?since=VERSION");
    Json list = Json::array();
    for (const auto& [key, version] :
         model_.tiles().changed_since(IslandId{numbers[0]}, version_of(request, "since")))
      list.push_back(Json::array({key.zoom, key.x, key.y, version}));
    answer(response, 200, list);
  }

  void tile(const Request& request, const std::vector<std::int32_t>& numbers, Response& response) {
    if (numbers.size() != 4) return refuse(response, 404, "/tile/ISLAND/ZOOM/X/Y?v=VERSION");
    const auto image = model_.tiles().image(IslandId{numbers[0]}, {numbers[1], numbers[2], numbers[3]});
    if (!image) return refuse(response, 404, "no such tile");
    answer(response, image->png, "image/png");
    if (image->version == version_of(request, "v")) keep_forever(response);
  }

  void patches(const Request& request, const std::vector<std::int32_t>& numbers, Response& response) {
    const auto shown = model_.shown();
    if (numbers.size() != 1 || !shown || !shown->version.contains(IslandId{numbers[0]}))
      return refuse(response, 404, "no such island");
    const IslandId island{numbers[0]};
    const std::int64_t version = shown->version.at(island);
    if (request.get_header_value("Accept-Encoding").find("deflate") == std::string::npos) {
      answer(response, std::make_shared<const std::string>(patch_arrays(*shown, island)),
             "application/octet-stream");
    } else {
      answer(response, packed_patches(*shown, island), "application/octet-stream");
      response.set_header("Content-Encoding", "deflate");
    }
    if (version == version_of(request, "v")) keep_forever(response);
  }

  /// Made once for each version.
  Text packed_patches(const ShownMap& shown, IslandId island) {
    const std::int64_t version = shown.version.at(island);
    const std::lock_guard lock(packing_);
    std::erase_if(packed_, [&](const auto& kept) { return !shown.version.contains(kept.first); });
    auto& [kept_version, text] = packed_[island];
    if (!text || kept_version < version) {
      text = deflated(patch_arrays(shown, island));
      kept_version = version;
    }
    return text;
  }

  /// One at a time: what is made for them is large.
  void download(const std::string& path, Response& response) {
    const auto shown = model_.shown();
    const std::unique_lock lock(downloading_, std::try_to_lock);
    if (!lock) {
      response.set_header("Retry-After", "2");
      return refuse(response, 503, "another download is being made");
    }
    std::optional<Download> made;
    if (shown) made = make_download(shown->map(), path.substr(std::string_view("/download/").size()));
    if (!made) return refuse(response, 404, "no such download");
    answer(response, std::make_shared<const std::string>(std::move(made->bytes)), made->type);
    response.set_header("Content-Disposition", "attachment; filename=\"" + made->name + "\"");
  }

  void preview(const Request& request, Response& response) {
    const auto shown = model_.shown();
    std::int32_t closure = -1;
    std::string text;
    if (shown && request.has_param("robot")) {
      text = robot_preview(*shown, request.get_param_value("robot"));
    } else if (shown && read_number(request.get_param_value("closure"), closure)) {
      text = closure_preview(*shown, ClosureId{closure});
    }
    if (text.empty()) return refuse(response, 404, "no such closure or robot");
    answer(response, std::make_shared<const std::string>(std::move(text)), json_type);
  }

  void order(const Request& request, Response& response) {
    const std::string type = request.get_header_value("Content-Type");
    if (type == "application/octet-stream") {
      const auto* bytes = reinterpret_cast<const std::uint8_t*>(request.body.data());
      return tell(orders_.send_signed({bytes, request.body.size()}), response);
    }
    // A type that pages of other sites cannot send without asking first.
    if (type != json_type) return refuse(response, 415, "application/json or application/octet-stream");
    if (options_.orders_signed) return refuse(response, 403, std::string(word(DropReason::not_signed)));
    const ParsedOrder parsed = parse_order(request.body);
    if (!parsed.order) return refuse(response, 400, parsed.error);
    tell(orders_.send(*parsed.order), response);
  }

  static void tell(const OrderAnswer& outcome, Response& response) {
    if (!outcome.answered) return refuse(response, 504, "no answer in time");
    if (outcome.reason != DropReason::none) return refuse(response, 409, std::string(word(outcome.reason)));
    answer(response, 200, {{"done", true}});
  }

  PageOptions options_;
  Access access_;
  PageModel model_;
  Orders orders_;
  std::atomic<std::size_t> taken_seats_ = 0;
  std::mutex downloading_;
  std::mutex packing_;
  std::map<IslandId, std::pair<std::int64_t, Text>> packed_;
  std::shared_ptr<ConnectionPool> pool_;
  httplib::Server http_;
  int port_ = 0;
  std::jthread thread_;
};

PageServer::PageServer(PageOptions options, TakeMessage take)
    : site_(std::make_unique<Site>(std::move(options), std::move(take))) {}

PageServer::~PageServer() = default;

int PageServer::port() const { return site_->port(); }
PageModel& PageServer::model() { return site_->model(); }
Orders& PageServer::orders() { return site_->orders(); }

}  // namespace isthmus
