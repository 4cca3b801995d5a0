#include "server/wire/foxglove/broadcast.hpp"

#include <algorithm>
#include <utility>

namespace isthmus::foxglove {

void Viewer::tell(std::string control) {
  if (!outbox_.add_control(std::move(control))) lost_ = true;
  wake_();
}

Broadcast::Broadcast(std::string session, Outbox::Limits limits)
    : session_(std::move(session)), limits_(limits) {}

Viewer& Broadcast::join(std::function<void()> wake) {
  Viewer& viewer = viewers_.emplace_back(limits_, std::move(wake));
  std::vector<FoxgloveChannel> all;
  for (const auto& [topic, open] : channels_) all.push_back(open.channel);
  viewer.tell(server_info(session_));
  viewer.tell(advertisement(all));
  return viewer;
}

void Broadcast::leave(const Viewer& viewer) {
  for (const auto& [channel, subscription] : viewer.subscription_of_)
    if (OpenChannel* open = find(channel)) open->listeners -= 1;
  std::erase_if(viewers_, [&](const Viewer& one) { return &one == &viewer; });
}

void Broadcast::hear(Viewer& viewer, std::string_view text) {
  const ViewerRequest request = parse_viewer_request(text);
  if (!request.wrong.empty()) return viewer.tell(complaint(request.wrong));
  for (const std::uint32_t subscription : request.unsubscribe) unsubscribe(viewer, subscription);
  for (const Subscription& subscription : request.subscribe) subscribe(viewer, subscription);
}

void Broadcast::subscribe(Viewer& viewer, const Subscription& subscription) {
  OpenChannel* open = find(subscription.channel);
  if (!open && subscription.channel < next_id_) return;  // closed while the request was on its way
  const bool is_used = std::ranges::any_of(viewer.subscription_of_,
                                           [&](const auto& one) { return one.second == subscription.id; });
  if (!open || is_used || viewer.subscription_of_.contains(subscription.channel)) {
    const char* why = !open ? "there is no such channel" : "the channel or the id has a subscription";
    return viewer.tell(complaint(why));
  }
  viewer.subscription_of_[subscription.channel] = subscription.id;
  open->listeners += 1;
  if (open->newest) hand_out(viewer, *open, open->newest_utime, open->newest);
}

void Broadcast::unsubscribe(Viewer& viewer, std::uint32_t subscription) {
  const auto found = std::ranges::find_if(viewer.subscription_of_,
                                          [&](const auto& one) { return one.second == subscription; });
  if (found == viewer.subscription_of_.end()) return viewer.tell(complaint("there is no such subscription"));
  if (OpenChannel* open = find(found->first)) open->listeners -= 1;
  viewer.outbox_.forget(found->first);
  viewer.subscription_of_.erase(found);
}

void Broadcast::open(const std::string& topic, Kind kind, Keep keep) {
  const auto [known, is_new] = channels_.try_emplace(topic);
  if (!is_new) return;
  known->second.channel = {next_id_++, topic, kind};
  known->second.keep = keep;
  for (Viewer& viewer : viewers_) viewer.tell(advertisement({known->second.channel}));
}

void Broadcast::close(const std::string& topic) {
  const auto known = channels_.find(topic);
  if (known == channels_.end()) return;
  const std::uint32_t id = known->second.channel.id;
  channels_.erase(known);
  for (Viewer& viewer : viewers_) {
    viewer.subscription_of_.erase(id);
    viewer.outbox_.forget(id);
    viewer.tell(withdrawal({id}));
  }
}

bool Broadcast::is_heard(const std::string& topic) const {
  const auto known = channels_.find(topic);
  return known != channels_.end() && known->second.listeners > 0;
}

void Broadcast::send(const std::string& topic, std::int64_t utime, std::string message) {
  OpenChannel& open = channels_.at(topic);
  const auto body = std::make_shared<const std::string>(std::move(message));
  if (open.keep == Keep::newest) {
    open.newest = body;
    open.newest_utime = utime;
  }
  for (Viewer& viewer : viewers_)
    if (viewer.subscription_of_.contains(open.channel.id)) hand_out(viewer, open, utime, body);
}

void Broadcast::hand_out(Viewer& viewer, const OpenChannel& open, std::int64_t utime, const Text& body) {
  const std::uint32_t id = open.channel.id;
  std::string head = data_head(viewer.subscription_of_.at(id), utime);
  if (open.keep == Keep::newest) {
    viewer.outbox_.add_newest(id, std::move(head), body);
  } else {
    viewer.outbox_.add_to_stream(id, std::move(head), body);
  }
  viewer.wake_();
}

Broadcast::OpenChannel* Broadcast::find(std::uint32_t channel) {
  for (auto& [topic, open] : channels_)
    if (open.channel.id == channel) return &open;
  return nullptr;
}

}  // namespace isthmus::foxglove
