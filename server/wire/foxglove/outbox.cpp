#include "server/wire/foxglove/outbox.hpp"

#include <algorithm>
#include <utility>

namespace isthmus::foxglove {
namespace {

bool is_of(const Outbox::Item& item, std::uint32_t channel) {
  return item.is_data && item.channel == channel;
}

}  // namespace

bool Outbox::add_control(std::string text) {
  control_bytes_ += text.size();
  waiting_.push_back({false, 0, "", std::make_shared<const std::string>(std::move(text))});
  return control_bytes_ <= limits_.control_bytes;
}

void Outbox::add_newest(std::uint32_t channel, std::string head, Text body) {
  const auto old = std::ranges::find_if(waiting_, [&](const Item& item) { return is_of(item, channel); });
  if (old == waiting_.end()) return add(channel, std::move(head), std::move(body));
  ++left_out_;
  data_bytes_ = data_bytes_ - old->body->size() + body->size();
  *old = {true, channel, std::move(head), std::move(body)};
}

void Outbox::add_to_stream(std::uint32_t channel, std::string head, Text body) {
  const auto waiting =
      std::ranges::count_if(waiting_, [&](const Item& item) { return is_of(item, channel); });
  if (static_cast<std::size_t>(waiting) >= limits_.stream_messages) {
    const auto oldest =
        std::ranges::find_if(waiting_, [&](const Item& item) { return is_of(item, channel); });
    data_bytes_ -= oldest->body->size();
    waiting_.erase(oldest);
    ++left_out_;
  }
  add(channel, std::move(head), std::move(body));
}

void Outbox::add(std::uint32_t channel, std::string head, Text body) {
  if (data_bytes_ + body->size() > limits_.data_bytes) {
    ++left_out_;
    return;
  }
  data_bytes_ += body->size();
  waiting_.push_back({true, channel, std::move(head), std::move(body)});
}

void Outbox::forget(std::uint32_t channel) {
  std::erase_if(waiting_, [&](const Item& item) {
    if (!is_of(item, channel)) return false;
    data_bytes_ -= item.body->size();
    return true;
  });
}

std::optional<Outbox::Item> Outbox::next() {
  if (waiting_.empty()) return std::nullopt;
  Item item = std::move(waiting_.front());
  waiting_.pop_front();
  (item.is_data ? data_bytes_ : control_bytes_) -= item.body->size();
  return item;
}

}  // namespace isthmus::foxglove
