#include "server/wire/page/page_server.hpp"

#include <httplib.h>

#include <array>
#include <atomic>
#include <charconv>
#include <stdexcept>
#include <thread>

#include "isthmus/annotation_t.hpp"
#include "isthmus/command_t.hpp"
#include "isthmus/initial_pose_t.hpp"
#include "isthmus/signed_t.hpp"
#include "server/wire/message/reason_sentence.hpp"
#include "server/wire/page/http/asset.hpp"
#include "server/wire/page/http/connection_pool.hpp"
#include "server/wire/page/http/map_resources.hpp"
#include "server/wire/page/map/download.hpp"
#include "server/wire/page/map/preview.hpp"

namespace isthmus {
namespace {

using httplib::Request;
using httplib::Response;
using Json = nlohmann::json;

constexpr std::size_t largest_order = 65'536;

/// The rest of the page must come from here, and nobody may put it into a page of theirs.
const httplib::Headers safe_headers = {
    {"Content-Security-Policy",
     "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src "
     "'self'; form-action 'self'; frame-ancestors 'none'; base-uri 'none'"},
    {"X-Content-Type-Options", "nosniff"},
    {"Referrer-Policy", "no-referrer"}};

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

/// Whether what is posted is no larger than it says: httplib puts no bound to what comes in chunks, nor to
/// what a few compressed bytes are inflated to.
bool is_bounded(const Request& request) {
  return !request.has_header("Transfer-Encoding") && !request.has_header("Content-Encoding");
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
        model_(PageModel::usual_interval, options_.journal_directory),
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
    http_.Post("/", [this](const Request& request, Response& response) { enter(request, response); });
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
    const bool is_order = request.path == "/command";
    if (request.method == "POST" && (is_order || request.path == "/")) {
      if (is_order && !access_.may_order(origin)) {
        refuse(response, 403, "not from here");
      } else if (!is_bounded(request)) {
        refuse(response, 411, "what is posted is sent with its length, and as it is");
      } else {
        return false;
      }
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

  /// By the form, or by a link that has the token in it. See Other: what was posted is not sent on.
  void enter(const Request& request, Response& response) {
    const std::string token = request.get_param_value("token");
    if (!access_.is_token(token)) return turn_away(request, response);
    response.set_header("Set-Cookie",
                        std::string(token_cookie) + "=" + token + "; Path=/; HttpOnly; SameSite=Lax");
    response.set_redirect("/", 303);
  }

  void turn_away(const Request& request, Response& response) const {
    if (!access_.needs_token()) return refuse(response, 403, "this page is served to this machine alone");
    if (request.path == "/") return ask_for_token(response, request.has_param("token"));
    if (request.path != "/token.css") return refuse(response, 401, "token");
    send_asset(request.path, response);
  }

  static void ask_for_token(Response& response, bool was_wrong) {
    std::string form(find_asset("/token.html")->bytes);
    constexpr std::string_view place = "<!-- wrong -->";
    form.replace(form.find(place), place.size(), was_wrong ? "Wrong token." : "");
    answer(response, std::make_shared<const std::string>(std::move(form)), "text/html; charset=utf-8");
    response.status = 401;
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
    if (path == "/past" || path.starts_with("/past/")) return past(request, response);
    if (path.starts_with("/download/")) return download(path, response);
    const auto shown = model_.shown();
    if (get_of_map({shown.get(), model_.tiles(), packed_}, path, request, response)) return;
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

  /// A list of what was, a map as it was, or what belongs to that.
  void past(const Request& request, Response& response) {
    const std::string_view path = std::string_view(request.path).substr(std::string_view("/past").size());
    if (path.empty())
      return answer(response, std::make_shared<const std::string>(model_.past_list()), json_type);
    const std::string_view rest = path.substr(std::min(path.find('/', 1), path.size()));
    std::int32_t snapshot = 0;
    if (!read_number(path.substr(1, path.size() - rest.size() - 1), snapshot))
      return refuse(response, 404, "/past/SNAPSHOT");
    const PastMaps::Found found = model_.past().find(snapshot);
    if (found.status == 503) response.set_header("Retry-After", "1");
    if (!found.map) return refuse(response, found.status, found.why);
    if (rest.empty()) return answer(response, found.map->text, json_type);
    if (!get_of_map({&found.map->shown, found.map->tiles, found.map->packed}, rest, request, response))
      refuse(response, 404, "nothing here");
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
    if (shown) made = make_download(*shown, path.substr(std::string_view("/download/").size()));
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
    if (text.empty()) return refuse(response, 404, "no such closure");
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
    if (options_.orders_signed) return refuse_order(response, 403, DropReason::not_signed);
    const ParsedOrder parsed = parse_order(request.body);
    if (!parsed.order) return refuse(response, 400, parsed.error);
    tell(orders_.send(*parsed.order), response);
  }

  static void refuse_order(Response& response, int status, DropReason reason) {
    const std::string_view error = word(reason);
    answer(response, status, {{"error", error}, {"words", sentence_of_order(error)}});
  }

  static void tell(const OrderAnswer& outcome, Response& response) {
    if (!outcome.answered) return refuse(response, 504, "no answer in time");
    if (outcome.reason != DropReason::none) return refuse_order(response, 409, outcome.reason);
    answer(response, 200,
           {{"done", true}, {"remark", outcome.remark}, {"words", sentence_of_order(outcome.remark)}});
  }

  PageOptions options_;
  Access access_;
  PageModel model_;
  Orders orders_;
  std::atomic<std::size_t> taken_seats_ = 0;
  std::mutex downloading_;
  PackedPatches packed_;
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
