#include "server/wire/recovery.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace isthmus {

Recovery::Recovery(const std::string& directory)
    : reader_(directory), first_(reader_.next()), has_events_(first_.has_value()) {}

void Recovery::configure(Engine& engine) {
  if (!first_) return;
  const Decoded decoded = decode(engine.configuration(), first_->channel, first_->bytes, first_->utime);
  if (!decoded.event || !std::holds_alternative<ConfigurationEvent>(decoded.event->body)) return;
  const auto parsed = parse_configuration(std::get<ConfigurationEvent>(decoded.event->body).toml,
                                          reader_.file() + ": its configuration");
  if (const std::string* error = std::get_if<std::string>(&parsed)) throw std::runtime_error(*error);
  take(engine, *std::exchange(first_, std::nullopt));
}

std::optional<Recovered> Recovery::step(Engine& engine) {
  const std::optional<Message> message = first_ ? std::exchange(first_, std::nullopt) : reader_.next();
  if (!message) return std::nullopt;
  return take(engine, *message);
}

Recovered Recovery::take(Engine& engine, const Message& message) {
  events_ += 1;
  Decoded decoded = decode(engine.configuration(), message.channel, message.bytes, message.utime);
  Recovered recovered;
  if (decoded.event) {
    last_utime_ = std::max(last_utime_, message.utime);
    recovered.outcome = engine.handle(*decoded.event);
    recovered.event = std::move(decoded.event);
  } else if (decoded.ours) {
    engine.count_dropped(decoded.robot, decoded.reason);
  }
  return recovered;
}

}  // namespace isthmus
