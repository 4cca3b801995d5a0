#include "server/wire/page/http/access.hpp"

#include <algorithm>
#include <cctype>
#include <stdexcept>
#include <string_view>

#include "server/wire/file/text_file.hpp"

namespace isthmus {
namespace {

constexpr std::size_t min_token = 16;

/// Without the port. An IPv6 address keeps its brackets.
std::string_view host_name(std::string_view host) {
  const std::size_t begin = host.starts_with('[') ? host.find(']') : 0;
  if (begin == std::string_view::npos) return host;
  return host.substr(0, host.find(':', begin));
}

/// A cookie's value; empty where there is none.
std::string_view cookie_value(std::string_view cookies, std::string_view name) {
  while (!cookies.empty()) {
    cookies.remove_prefix(std::min(cookies.find_first_not_of("; "), cookies.size()));
    const std::string_view one = cookies.substr(0, cookies.find(';'));
    if (one.starts_with(name) && one.substr(name.size()).starts_with('=')) return one.substr(name.size() + 1);
    cookies.remove_prefix(one.size());
  }
  return {};
}

bool is_token_character(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' || c == '.';
}

}  // namespace

/// In a time that does not tell where they differ.
bool Access::is_token(const std::string& text) const {
  if (text.size() != token_.size() || token_.empty()) return false;
  unsigned differences = 0;
  for (std::size_t i = 0; i < token_.size(); ++i)
    differences |= static_cast<unsigned char>(text[i]) ^ static_cast<unsigned char>(token_[i]);
  return differences == 0;
}

bool Access::may_see(const RequestOrigin& request) const {
  if (!needs_token()) {
    const std::string_view host = host_name(request.host);
    return host == "localhost" || is_loopback(std::string(host));
  }
  constexpr std::string_view bearer = "Bearer ";
  if (request.authorization.starts_with(bearer)) return is_token(request.authorization.substr(bearer.size()));
  return is_token(std::string(cookie_value(request.cookie, token_cookie)));
}

bool Access::may_order(const RequestOrigin& request) const {
  return may_see(request) && (request.origin.empty() || request.origin == "http://" + request.host);
}

std::string read_token(const std::string& file) {
  const std::string text = read_text_file(file);
  check_key_file(file);
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  const std::size_t end = text.find_last_not_of(" \t\r\n");
  std::string token = begin == std::string::npos ? "" : text.substr(begin, end - begin + 1);
  if (token.size() < min_token || !std::ranges::all_of(token, is_token_character))
    throw std::runtime_error(file +
                             ": must hold a token of at least 16 letters, digits, '-', '_' and '.', and no "
                             "more (openssl rand -hex 32)");
  return token;
}

bool is_loopback(const std::string& address) {
  // A name may begin with 127 too, and lead anywhere.
  const bool is_number = address.find_first_not_of("0123456789.") == std::string::npos;
  return (is_number && address.starts_with("127.")) || address == "::1" || address == "[::1]" ||
         address == "localhost";
}

}  // namespace isthmus
