#include "server/wire/foxglove/protocol.hpp"

#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

namespace isthmus::foxglove {
namespace {

using Json = nlohmann::json;

constexpr char message_data = 1;
constexpr int complaint_level = 1;

/// A member's number of 32 bits; nothing where it is something else.
std::optional<std::uint32_t> number(const Json& value) {
  if (!value.is_number_unsigned()) return std::nullopt;
  const auto wide = value.get<std::uint64_t>();
  if (wide > std::numeric_limits<std::uint32_t>::max()) return std::nullopt;
  return static_cast<std::uint32_t>(wide);
}

std::optional<std::uint32_t> number(const Json& object, const char* name) {
  const auto found = object.is_object() ? object.find(name) : object.end();
  return found == object.end() ? std::nullopt : number(*found);
}

ViewerRequest wrong(const std::string& why) { return {{}, {}, why}; }

ViewerRequest subscribing(const Json& message) {
  ViewerRequest request;
  const auto list = message.find("subscriptions");
  if (list == message.end() || !list->is_array()) return wrong("subscribe without subscriptions");
  for (const Json& one : *list) {
    const auto id = number(one, "id"), channel = number(one, "channelId");
    if (!id || !channel) return wrong("a subscription needs an id and a channelId");
    request.subscribe.push_back({*id, *channel});
  }
  return request;
}

ViewerRequest unsubscribing(const Json& message) {
  ViewerRequest request;
  const auto list = message.find("subscriptionIds");
  if (list == message.end() || !list->is_array()) return wrong("unsubscribe without subscriptionIds");
  for (const Json& one : *list) {
    const auto id = number(one);
    if (!id) return wrong("a subscription's id is no number");
    request.unsubscribe.push_back(*id);
  }
  return request;
}

template <class Number>
void append(std::string& bytes, Number value) {
  for (std::size_t i = 0; i < sizeof value; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xFF);
}

}  // namespace

std::string server_info(const std::string& session) {
  return Json{{"op", "serverInfo"},
              {"name", "isthmus"},
              {"capabilities", Json::array()},
              {"supportedEncodings", {"json"}},
              {"metadata", Json::object()},
              {"sessionId", session}}
      .dump();
}

std::string advertisement(const std::vector<FoxgloveChannel>& channels) {
  Json list = Json::array();
  for (const FoxgloveChannel& channel : channels) {
    const Schema fields = schema(channel.kind);
    list.push_back({{"id", channel.id},
                    {"topic", channel.topic},
                    {"encoding", "json"},
                    {"schemaName", fields.name},
                    {"schemaEncoding", "jsonschema"},
                    {"schema", fields.text}});
  }
  return Json{{"op", "advertise"}, {"channels", list}}.dump();
}

std::string withdrawal(const std::vector<std::uint32_t>& channels) {
  return Json{{"op", "unadvertise"}, {"channelIds", channels}}.dump();
}

std::string complaint(const std::string& what) {
  return Json{{"op", "status"}, {"level", complaint_level}, {"message", what}}.dump();
}

std::string data_head(std::uint32_t subscription, std::int64_t utime) {
  std::string bytes(1, message_data);
  append(bytes, subscription);
  append(bytes, static_cast<std::uint64_t>(std::max<std::int64_t>(utime, 0)) * 1000);
  return bytes;
}

ViewerRequest parse_viewer_request(std::string_view text) {
  const Json message = Json::parse(text, nullptr, false);
  if (!message.is_object()) return wrong("no JSON object");
  const auto op = message.find("op");
  if (op == message.end() || !op->is_string()) return wrong("no op");
  if (*op == "subscribe") return subscribing(message);
  if (*op == "unsubscribe") return unsubscribing(message);
  return {};
}

}  // namespace isthmus::foxglove
