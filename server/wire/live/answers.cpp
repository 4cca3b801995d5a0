#include "server/wire/live/answers.hpp"

#include "isthmus/answer_t.hpp"
#include "server/engine/input/annotation_kind.hpp"
#include "server/wire/message/encoded.hpp"

namespace isthmus {
namespace {

/// "ALICE" of "ALICE@0123456789ab": counters are kept by sender and key.
std::string name_of(const std::optional<Signature>& signer) {
  return signer ? signer->sender.substr(0, signer->sender.find('@')) : "";
}

LogFields fields_of(const answer_t& answer) {
  LogFields fields = {{"order", answer.verb}};
  if (answer.closure >= 0) fields.push_back({"closure", std::to_string(answer.closure)});
  const bool is_drawn = value_of<AnnotationKind>(answer.verb).has_value();  // a place or zone has a name
  if (!answer.robot.empty()) fields.push_back({is_drawn ? "name" : "robot", answer.robot});
  fields.push_back({"by", answer.sender.empty() ? "(unsigned)" : answer.sender});
  if (!answer.reason.empty()) fields.push_back({answer.done ? "remark" : "reason", answer.reason});
  return fields;
}

}  // namespace

void Answers::tell(const command_t& order, const std::optional<Signature>& signer, DropReason reason,
                   const std::string& remark, std::int64_t utime) const {
  answer_t answer{};
  answer.utime = utime;
  answer.order_utime = order.utime;
  answer.verb = order.verb;
  answer.closure = order.closure;
  answer.robot = order.robot;
  answer.sender = name_of(signer);
  answer.done = reason == DropReason::none ? 1 : 0;
  answer.reason = answer.done ? remark : std::string(word(reason));
  if (log_)
    log_(answer.done ? LogLevel::info : LogLevel::warning,
         answer.done ? "an order is carried out" : "an order is refused", fields_of(answer));
  publish_("ISTHMUS_ANSWER", encoded(answer));
}

}  // namespace isthmus
