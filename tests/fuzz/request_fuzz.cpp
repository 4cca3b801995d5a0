#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>

#include "server/wire/message/encoded.hpp"
#include "server/wire/questions/answerer.hpp"

/// Input: the bytes of a request. Whatever they are, they are refused, or what was read is the same once it
/// is written and read again and gets its reply over a map of nothing.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace isthmus;
  const std::optional<request_t> request = read_request({data, size});
  if (!request) return 0;
  const auto bytes = encoded(*request);
  if (!std::equal(bytes.begin(), bytes.end(), data, data + size)) std::abort();
  const QuestionReading reading = read_question(*request);
  if (reading.question.has_value() == (reading.refusal != QuestionRefusal::none)) std::abort();
  if (!reading.question) return 0;
  Answerer answerer;
  answerer.update(std::make_shared<const MapCopy>(), 1);
  const reply_t reply = answerer.answer(*reading.question, {}, {});
  if ((reply.done != 0) != reply.reason.empty()) std::abort();
  const bool is_way = reading.question->kind == QuestionKind::path;
  if (is_way && answerer.update_of(*reading.question, reply, {}, {})) std::abort();  // nothing has changed
  return 0;
}
