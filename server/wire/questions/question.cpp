#include "server/wire/questions/question.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/engine/input/robot_name.hpp"
#include "server/wire/message/byte_check.hpp"
#include "server/wire/message/channel.hpp"
#include "server/wire/message/members.hpp"
#include "server/wire/message/read_message.hpp"
#include "server/wire/trust/envelope.hpp"

namespace isthmus {
namespace {

constexpr Member planar_pose = fixed(3 * 8);
constexpr std::array request_members = {
    members::number,  members::number,  members::name,   members::name,   members::number, members::name,
    members::integer, planar_pose,      members::name,   members::name,   members::name,   members::integer,
    planar_pose,      members::integer, members::number, members::number, members::number, members::number};

bool are_finite(const double (&values)[3]) {
  return std::all_of(std::begin(values), std::end(values), [](double value) { return std::isfinite(value); });
}

bool is_name(const std::string& upper) { return upper.empty() || is_robot_name(upper); }

bool has_target(QuestionKind kind) {
  return kind == QuestionKind::path || kind == QuestionKind::relative_pose;
}

bool is_way(QuestionKind kind) { return kind == QuestionKind::path || kind == QuestionKind::retro_traverse; }

bool can_follow(QuestionKind kind, double follow_s) {
  return follow_s == 0 || (is_way(kind) && follow_s > 0 && follow_s <= max_follow_s);
}

bool are_believable(const request_t& request) {
  return is_plausible_utime(request.utime) && is_plausible_utime(request.since) && request.timeout_s > 0 &&
         request.timeout_s <= max_question_timeout_s && are_finite(request.patch_from_start) &&
         are_finite(request.patch_from_target) && std::isfinite(request.radius_m) &&
         std::isfinite(request.clearance_m);
}

}  // namespace

std::optional<request_t> read_request(std::span<const std::uint8_t> bytes) {
  if (check_bytes(request_t::getHash(), request_members, bytes) != DropReason::none) return std::nullopt;
  request_t request;
  const int size = static_cast<int>(bytes.size());
  if (request.decode(bytes.data(), 0, size) != size) return std::nullopt;
  return request;
}

QuestionReading read_question(request_t request) {
  const std::optional<QuestionKind> kind = value_of<QuestionKind>(request.kind);
  if (!kind) return {std::nullopt, QuestionRefusal::bad_kind};
  const std::optional<Target> target = has_target(*kind) ? value_of<Target>(request.target) : Target::pose;
  if (!target) return {std::nullopt, QuestionRefusal::bad_kind};
  request.robot = upper_case(request.robot);
  request.target_robot = upper_case(request.target_robot);
  if (request.asker.empty() || !is_name(request.robot) || !is_name(request.target_robot))
    return {std::nullopt, QuestionRefusal::bad_name};
  if (!are_believable(request) || !can_follow(*kind, request.follow_s))
    return {std::nullopt, QuestionRefusal::bad_value};
  return {Question{std::move(request), *kind, *target}, QuestionRefusal::none};
}

std::optional<request_t> request_in(const std::string& channel, std::span<const std::uint8_t> bytes) {
  if (is_request_channel(channel)) return read_request(bytes);
  if (channel != signed_channel) return std::nullopt;
  Envelope envelope;
  if (read_envelope(bytes, envelope) != DropReason::none || !is_request_channel(envelope.channel))
    return std::nullopt;
  return read_request(envelope.payload);
}

}  // namespace isthmus
