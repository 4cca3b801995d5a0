#include "server/wire/page/http/http_answer.hpp"

#include <httplib.h>

namespace isthmus {

/// httplib compresses what it is given whole, anew for each request, and some slowly: given piece by piece it
/// is sent as it is.
void answer(httplib::Response& response, const SharedText& bytes, const std::string& type) {
  response.set_header("Cache-Control", "no-store");
  if (bytes->empty()) return;
  response.set_content_provider(bytes->size(), type,
                                [bytes](std::size_t offset, std::size_t size, httplib::DataSink& sink) {
                                  return sink.write(bytes->data() + offset, size);
                                });
}

void answer(httplib::Response& response, int status, const nlohmann::json& json) {
  response.status = status;
  answer(response, std::make_shared<const std::string>(json.dump()), json_type);
}

void refuse(httplib::Response& response, int status, const std::string& why) {
  answer(response, status, {{"error", why}});
}

void keep_forever(httplib::Response& response) {
  response.headers.erase("Cache-Control");
  response.set_header("Cache-Control", "private, max-age=31536000, immutable");
}

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

std::int64_t version_of(const httplib::Request& request, const char* name) {
  std::int64_t version = 0;
  return read_number(request.get_param_value(name), version) ? version : 0;
}

}  // namespace isthmus
