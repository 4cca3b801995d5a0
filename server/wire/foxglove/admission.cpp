#include "server/wire/foxglove/admission.hpp"

#include <algorithm>

#include "server/wire/foxglove/protocol.hpp"

namespace isthmus::foxglove {
namespace {

constexpr std::string_view own_page_of_foxglove = "https://app.foxglove.dev";

/// "http://127.0.0.1:8080": 127.0.0.1.
std::string host_of(std::string_view url) {
  const std::size_t scheme = url.find("://");
  if (scheme == std::string_view::npos) return "";
  url.remove_prefix(scheme + 3);
  if (url.starts_with('[')) return std::string(url.substr(0, url.find(']') + 1));
  return std::string(url.substr(0, url.find(':')));
}

/// Pages of the web have the origin of their site, or "null"; programs have none or a scheme of their own.
bool is_trusted(const std::string& origin) {
  if (origin.empty() || origin == own_page_of_foxglove) return true;
  const bool is_of_web = origin.starts_with("http://") || origin.starts_with("https://");
  if (is_of_web) return is_loopback(host_of(origin));
  return origin != "null";
}

std::string token_in(std::string_view target) {
  constexpr std::string_view name = "token=";
  const std::size_t query = target.find('?');
  if (query == std::string_view::npos) return "";
  target.remove_prefix(query + 1);
  while (!target.empty()) {
    const std::string_view one = target.substr(0, target.find('&'));
    if (one.starts_with(name)) return std::string(one.substr(name.size()));
    target.remove_prefix(std::min(one.size() + 1, target.size()));
  }
  return "";
}

}  // namespace

bool may_watch(const Access& access, const Handshake& handshake) {
  const RequestOrigin without_cookie = {handshake.host, handshake.origin, "", handshake.authorization};
  if (access.needs_token())
    return access.is_token(token_in(handshake.target)) || access.may_see(without_cookie);
  return access.may_see(without_cookie) && is_trusted(handshake.origin);
}

std::string_view subprotocol_for(const Handshake& handshake) {
  for (const std::string_view known : subprotocols) {
    std::string_view asked = handshake.protocols;
    while (!asked.empty()) {
      asked.remove_prefix(std::min(asked.find_first_not_of(", \t"), asked.size()));
      const std::string_view one = asked.substr(0, asked.find_first_of(", \t"));
      if (one == known) return known;
      asked.remove_prefix(one.size());
    }
  }
  return "";
}

}  // namespace isthmus::foxglove
