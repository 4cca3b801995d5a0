#pragma once

#include <string>

namespace isthmus {

/// What a request says of where it comes from; empty: nothing.
struct RequestOrigin {
  std::string host;           ///< header Host
  std::string origin;         ///< header Origin
  std::string cookie;         ///< header Cookie
  std::string authorization;  ///< header Authorization
};

/// Who may see the page.
class Access {
 public:
  /// Without a token, whoever is on this machine: requests must name it as their host, so that no other page
  /// in somebody's browser reaches this one by a name that leads here. With one, whoever has it.
  explicit Access(std::string token = "") : token_(std::move(token)) {}

  bool needs_token() const { return !token_.empty(); }
  bool is_token(const std::string& text) const;
  /// Whether it may see the page: by its host, or by the token as a cookie or as "Bearer".
  bool may_see(const RequestOrigin& request) const;
  /// Whether it may order something: not where another site's page sent it.
  bool may_order(const RequestOrigin& request) const;

 private:
  std::string token_;
};

inline constexpr const char* token_cookie = "isthmus_token";

/// Reads a token: the file's text without the white space around it. Throws std::runtime_error naming the
/// file where it cannot be read, anybody may write it, it has fewer than 16 characters, or characters other
/// than letters, digits, '-', '_' and '.'.
std::string read_token(const std::string& file);

/// Whether an address is of this machine alone.
bool is_loopback(const std::string& address);

}  // namespace isthmus
