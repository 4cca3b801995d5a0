#pragma once

#include <charconv>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "server/wire/page/map/packed_patches.hpp"

namespace httplib {
struct Request;
struct Response;
}  // namespace httplib

namespace isthmus {

inline constexpr const char* json_type = "application/json";

/// Sends bytes as they are, not to be kept by the browser.
void answer(httplib::Response& response, const SharedText& bytes, const std::string& type);
void answer(httplib::Response& response, int status, const nlohmann::json& json);
void refuse(httplib::Response& response, int status, const std::string& why);
/// The answer may be kept by the browser: what it was asked for by never changes.
void keep_forever(httplib::Response& response);

/// The whole text as a number; false: it is none.
template <class Number>
bool read_number(std::string_view text, Number& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size();
}

/// "/tile/3/0/1/2" behind "/tile": 3, 0, 1, 2; none where one is no number.
std::vector<std::int32_t> numbers_behind(std::string_view path, std::string_view name);

/// A version that a request names; 0: none.
std::int64_t version_of(const httplib::Request& request, const char* name);

}  // namespace isthmus
