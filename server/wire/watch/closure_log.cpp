#include "server/wire/watch/closure_log.hpp"

namespace isthmus {
namespace {

std::string joined(const std::vector<std::string>& robots) {
  std::string text;
  for (const std::string& robot : robots) text += (text.empty() ? "" : ",") + robot;
  return text;
}

}  // namespace

void ClosureLog::tell(const std::vector<ClosureRecord>& closures, const Log& log) {
  for (const ClosureRecord& closure : closures) {
    ClosureState& state = states_[closure.id];
    if (state == closure.state) continue;
    state = closure.state;
    if (state == ClosureState::waiting || !log) continue;
    LogFields fields = {{"closure", std::to_string(closure.id.value)},
                        {"reason", std::string(word(closure.reason))},
                        {"robots", joined(closure.robots)},
                        {"patches", std::to_string(closure.patches_touched)}};
    if (closure.account.blamed > 0)
      fields.emplace_back("blamed_relations", std::to_string(closure.account.blamed));
    if (closure.account.blamed_closure.valid())
      fields.emplace_back("blamed_closure", std::to_string(closure.account.blamed_closure.value));
    log(LogLevel::info, std::string(word(closure.kind)) + " " + std::string(word(state)), fields);
  }
}

}  // namespace isthmus
