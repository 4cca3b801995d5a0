#include "server/engine/frozen/finder.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "server/engine/localise/mapper.hpp"

namespace isthmus {
namespace {

constexpr double spacing_m = 4;              // of anchors
constexpr double half_window_m = 4;          // about an anchor: the next one has the rest
constexpr std::size_t least_island = 6;      // patches: less is no place
constexpr double piece_way_m = 8;            // what is searched for: so much of the way, at most
constexpr double least_piece_way_m = 2;      // and at least
constexpr double least_half_yaw_rad = 0.15;  // of a window
constexpr double least_score = 0.6;
constexpr double agreeing_m = 0.5;  // two finds that say the same
constexpr double agreeing_rad = 0.1;
constexpr double agreeing_way_m = 1;  // between them: less is the same view twice
constexpr std::size_t most_sighted = 8;
constexpr std::size_t most_sketch_patches = 150;
constexpr std::int64_t least_price_us = 1'000;  // nominal, of one step
constexpr double price_per_evaluation_us = 0.4;

// Anchors so far apart that each patch of an island is near one of them.
void append_anchors(const Map& map, const std::vector<PatchId>& island, std::vector<PatchId>& anchors) {
  const auto first = static_cast<std::ptrdiff_t>(anchors.size());
  for (const PatchId id : island) {
    if (map.manifold().patch(id).points.empty()) continue;
    const Pose& pose = map.manifold().pose(id);
    const bool covered = std::any_of(anchors.begin() + first, anchors.end(), [&](PatchId other) {
      const Pose& its = map.manifold().pose(other);
      return std::hypot(its.x - pose.x, its.y - pose.y) < spacing_m;
    });
    if (!covered) anchors.push_back(id);
  }
}

}  // namespace

std::vector<RigidPiece> all_places(const Map& map, const EngineOptions& options) {
  std::vector<PatchId> anchors;
  for (const std::vector<PatchId>& island : map.graph().islands())
    if (island.size() >= least_island) append_anchors(map, island, anchors);
  std::vector<RigidPiece> places;
  for (const PatchId anchor : anchors) places.push_back(place_around(map, anchor, options));
  return places;
}

void Finder::take_scan(const Robot& robot, Observation observation, const Pose& odom_from_robot,
                       const EngineOptions& options) {
  if (sketch_.manifold().size() >= most_sketch_patches) *this = {};
  robot_.declaration = robot.declaration;
  const bool first = !robot_.place;
  if (first) robot_.noise = robot.noise;
  const std::int64_t utime = observation.scan.utime;
  const ScanOutcome done =
      isthmus::take_scan(sketch_, robot_, std::move(observation), odom_from_robot, options);
  if (done.new_session) {
    newest_first_.clear();
    from_newest_m_.clear();
    sighted_.clear();
    found_.reset();
    query_.reset();
    since_utime_ = utime;
  }
  if (newest_first_.empty() || newest_first_.front() != robot_.place->last_patch) note_patch();
}

void Finder::note_patch() {
  const PatchId patch = robot_.place->last_patch;
  const Manifold& manifold = sketch_.manifold();
  if (!newest_first_.empty()) {
    const Pose moved = ominus(manifold.pose(patch), manifold.pose(newest_first_.front()));
    for (double& from_newest : from_newest_m_) from_newest += std::hypot(moved.x, moved.y);
  }
  newest_first_.push_front(patch);
  from_newest_m_.push_front(0);
  while (from_newest_m_.back() > piece_way_m) {
    newest_first_.pop_back();
    from_newest_m_.pop_back();
  }
  due_ = from_newest_m_.back() >= least_piece_way_m;
}

std::int64_t Finder::step(const Map& map, const std::vector<RigidPiece>& places, const EngineOptions& options,
                          FinderCounts& counts) {
  if (!query_) begin(places.size(), counts);
  if (!query_->windows.empty()) return search_next(places, counts);
  const std::int64_t price = decide(map, options, counts);
  query_.reset();
  return price;
}

void Finder::begin(std::size_t places, FinderCounts& counts) {
  due_ = false;
  ++counts.queries;
  const std::vector<PatchId> way(newest_first_.begin(), newest_first_.end());
  query_ = Query{};
  query_->piece = piece_of_way(sketch_, way);
  for (std::size_t i = 0; i < places; ++i) query_->windows.push_back({i, Pose{}, std::numbers::pi});
}

std::int64_t Finder::search_next(const std::vector<RigidPiece>& places, FinderCounts& counts) {
  Query& query = *query_;
  ++counts.places_searched;
  const Window window = query.windows.front();
  query.windows.pop_front();
  const PlaceSearch search = search_place(places[window.place], query.piece,
                                          {window.centre, half_window_m, half_window_m, window.half_yaw_rad},
                                          std::max(least_score, ambiguous_share * query.best_score));
  if (search.exhausted) search_halves(window);
  for (const PlaceAnswer& answer : search.answers) {
    query.best_score = std::max(query.best_score, answer.score);
    query.answers.push_back(answer);
  }
  return least_price_us +
         static_cast<std::int64_t>(price_per_evaluation_us * static_cast<double>(search.evaluations));
}

// What is too much for one step is done in two, once more is known of what is worth finding.
void Finder::search_halves(const Window& window) {
  const double half = 0.5 * window.half_yaw_rad;
  if (half < least_half_yaw_rad) {
    query_->exhausted = true;
    return;
  }
  for (const double yaw : {window.centre.yaw - half, window.centre.yaw + half})
    query_->windows.push_back({window.place, {0, 0, wrap_angle(yaw)}, half});
}

std::int64_t Finder::decide(const Map& map, const EngineOptions& options, FinderCounts& counts) {
  Query& query = *query_;
  std::ranges::stable_sort(query.answers, std::ranges::greater{}, &PlaceAnswer::score);
  if (query.answers.empty()) return least_price_us;
  if (query.exhausted || !is_unique(map, query.answers)) {
    ++counts.ambiguous;
    return least_price_us;
  }
  const PlaceAnswer& best = query.answers.front();
  const std::optional<Find> find =
      refine(place_around(map, best.anchor, options), query.piece, best, options);
  if (find) {
    ++counts.finds;
    take(map, *find);
  }
  return 5 * least_price_us;
}

// One find may be of another place that looks alike: it takes two, of two pieces of the way, that agree.
void Finder::take(const Map& map, const Find& find) {
  Sighted sighted;
  sighted.query = find.query;
  sighted.newest = query_->piece.local.reference;
  sighted.pose = {find.anchor, find.anchor_from_query};
  sighted.map_from_sketch =
      map.manifold().project(sighted.pose) * inverse(sketch_.manifold().pose(find.query));
  sighted.island = map.graph().island(find.anchor);
  const Pose here = sketch_from_robot();
  const Pose& newest = sketch_.manifold().pose(sighted.newest);
  const bool agreed = std::ranges::any_of(sighted_, [&](const Sighted& other) {
    const Pose off = ominus(other.map_from_sketch * here, sighted.map_from_sketch * here);
    const Pose& its = sketch_.manifold().pose(other.newest);
    return other.island == sighted.island && std::hypot(off.x, off.y) < agreeing_m &&
           std::abs(off.yaw) < agreeing_rad &&
           std::hypot(its.x - newest.x, its.y - newest.y) >= agreeing_way_m;
  });
  if (agreed) found_ = sighted;
  sighted_.push_back(sighted);
  if (sighted_.size() > most_sighted) sighted_.pop_front();
}

std::optional<ManifoldPose> Finder::take_found() {
  if (!found_) return std::nullopt;
  const Sighted found = *std::exchange(found_, std::nullopt);
  sighted_.clear();  // should it prove false, they are
  const Pose query_from_robot = ominus(sketch_from_robot(), sketch_.manifold().pose(found.query));
  return ManifoldPose{found.pose.patch, found.pose.patch_from_object * query_from_robot};
}

}  // namespace isthmus
