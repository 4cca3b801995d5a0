#include "server/engine/frozen/finder.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "server/engine/localise/mapper.hpp"

namespace isthmus {
namespace {

// Anchors so far apart that each patch of an island is near one of them.
void append_anchors(const Map& map, const std::vector<PatchId>& island, double spacing_m,
                    std::vector<PatchId>& anchors) {
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
    if (island.size() >= options.place_candidates.min_island)
      append_anchors(map, island, options.place_candidates.spacing_m, anchors);
  std::vector<RigidPiece> places;
  for (const PatchId anchor : anchors) places.push_back(place_around(map, anchor, options));
  return places;
}

void Finder::take_scan(const Robot& robot, Observation observation, const Pose& odom_from_robot,
                       const EngineOptions& options) {
  if (sketch_.manifold().size() >= options.finder.max_sketch_patches) *this = {};
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
  if (newest_first_.empty() || newest_first_.front() != robot_.place->last_patch) note_patch(options.finder);
}

void Finder::note_patch(const FinderOptions& options) {
  const PatchId patch = robot_.place->last_patch;
  const Manifold& manifold = sketch_.manifold();
  if (!newest_first_.empty()) {
    const Pose moved = manifold.relative_pose(newest_first_.front(), patch);
    for (double& from_newest : from_newest_m_) from_newest += std::hypot(moved.x, moved.y);
  }
  newest_first_.push_front(patch);
  from_newest_m_.push_front(0);
  while (from_newest_m_.back() > options.max_piece_way_m) {
    newest_first_.pop_back();
    from_newest_m_.pop_back();
  }
  due_ = from_newest_m_.back() >= options.min_piece_way_m;
}

std::int64_t Finder::step(const Map& map, const std::vector<RigidPiece>& places, const EngineOptions& options,
                          FinderCounts& counts) {
  if (!query_) begin(places.size(), options, counts);
  if (!query_->windows.empty()) return search_next(places, options, counts);
  const std::int64_t price = decide(map, options, counts);
  query_.reset();
  return price;
}

void Finder::begin(std::size_t places, const EngineOptions& options, FinderCounts& counts) {
  due_ = false;
  ++counts.queries;
  const std::vector<PatchId> way(newest_first_.begin(), newest_first_.end());
  query_ = Query{};
  query_->piece = piece_of_way(sketch_, way, options.place_search);
  for (std::size_t i = 0; i < places; ++i) query_->windows.push_back({i, Pose{}, std::numbers::pi});
}

std::int64_t Finder::search_next(const std::vector<RigidPiece>& places, const EngineOptions& options,
                                 FinderCounts& counts) {
  Query& query = *query_;
  ++counts.places_searched;
  const double half_m = options.place_candidates.half_window_m;
  const Window window = query.windows.front();
  query.windows.pop_front();
  const PlaceSearch search =
      search_place(places[window.place], query.piece, {window.centre, half_m, half_m, window.half_yaw_rad},
                   std::max(options.finder.min_score, options.ambiguity.share * query.best_score), options);
  if (search.exhausted) search_halves(window, options.finder);
  for (const PlaceAnswer& answer : search.answers) {
    query.best_score = std::max(query.best_score, answer.score);
    query.answers.push_back(answer);
  }
  return options.finder.step_price_us + static_cast<std::int64_t>(options.finder.evaluation_price_us *
                                                                  static_cast<double>(search.evaluations));
}

// What is too much for one step is done in two, once more is known of what is worth finding.
void Finder::search_halves(const Window& window, const FinderOptions& options) {
  const double half = 0.5 * window.half_yaw_rad;
  if (half < options.min_half_window_rad) {
    query_->exhausted = true;
    return;
  }
  for (const double yaw : {window.centre.yaw - half, window.centre.yaw + half})
    query_->windows.push_back({window.place, {0, 0, wrap_angle(yaw)}, half});
}

std::int64_t Finder::decide(const Map& map, const EngineOptions& options, FinderCounts& counts) {
  Query& query = *query_;
  std::ranges::stable_sort(query.answers, std::ranges::greater{}, &PlaceAnswer::score);
  const FinderOptions& its = options.finder;
  if (query.answers.empty()) return its.step_price_us;
  if (query.exhausted || !is_unique(map, query.answers, options)) {
    ++counts.ambiguous;
    return its.step_price_us;
  }
  const PlaceAnswer& best = query.answers.front();
  const std::optional<Find> find =
      refine(place_around(map, best.anchor, options), query.piece, best, options);
  if (find) {
    ++counts.finds;
    take(map, *find, its);
  }
  return static_cast<std::int64_t>(its.decision_steps * static_cast<double>(its.step_price_us));
}

// One find may be of another place that looks alike: it takes two, of two pieces of the way, that agree.
void Finder::take(const Map& map, const Find& find, const FinderOptions& options) {
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
    return other.island == sighted.island && std::hypot(off.x, off.y) < options.agreeing_m &&
           std::abs(off.yaw) < options.agreeing_rad &&
           std::hypot(its.x - newest.x, its.y - newest.y) >= options.agreeing_way_m;
  });
  if (agreed) found_ = sighted;
  sighted_.push_back(sighted);
  if (sighted_.size() > options.max_finds) sighted_.pop_front();
}

std::optional<ManifoldPose> Finder::take_found() {
  if (!found_) return std::nullopt;
  const Sighted found = *std::exchange(found_, std::nullopt);
  sighted_.clear();  // should it prove false, they are
  const Pose query_from_robot = ominus(sketch_from_robot(), sketch_.manifold().pose(found.query));
  return ManifoldPose{found.pose.patch, found.pose.patch_from_object * query_from_robot};
}

}  // namespace isthmus
