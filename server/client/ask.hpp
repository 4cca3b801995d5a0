#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "isthmus/reply_t.hpp"
#include "isthmus/request_t.hpp"

namespace lcm {
class LCM;
}

namespace isthmus {

/// What questions are signed with, where the server has keys: a name of its [auth] and that one's key.
struct QuestionKey {
  std::string name;
  std::array<std::uint8_t, 32> key{};
};

/// A question of this kind by this asker, who stands where this robot is; the rest is empty or 0, but the
/// robot's outline of .25 m and .1 m more from walls (lcmtypes/README.md, "Questions").
request_t question(const std::string& kind, const std::string& asker, const std::string& robot);

/// Publishes a question on ISTHMUS_REQUEST, in an envelope where there is a key, and waits for its reply for
/// `timeout_s` of it; nothing where none came. Its `utime` is set by this machine's clock, and `id` where it
/// is 0. Other messages that come meanwhile are handled. Throws std::runtime_error where the network does not
/// take the message.
std::optional<reply_t> ask(lcm::LCM& lcm, request_t request, const std::optional<QuestionKey>& key = {});

/// Asks for a path, and is told what becomes of it for `follow_s` of the request: `tell` gets the answer and
/// each update until it says false, or the last has come. Whether it ended so; false where the server was not
/// heard in time. Else as `ask`.
bool follow(lcm::LCM& lcm, request_t request, const std::function<bool(const reply_t&)>& tell,
            const std::optional<QuestionKey>& key = {});

}  // namespace isthmus
