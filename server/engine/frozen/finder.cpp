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

SearchTerms terms_of(const FinderOptions& options) {
  SearchTerms terms;
  terms.min_score = terms.min_score_anywhere = options.common.sure_score;
  terms.min_carrier_score = options.common.doubtful_score;
  terms.min_half_window_rad = options.min_half_window_rad;
  return terms;
}

}  // namespace

std::vector<RigidPiece> all_places(const Map& map, const EngineOptions& options) {
  std::vector<PatchId> anchors;
  for (const std::vector<PatchId>& island : map.graph().islands())
    if (island.size() >= options.place_candidates.min_island)
      append_anchors(map, island, options.place_candidates.spacing_m, anchors);
  std::vector<RigidPiece> places;
  for (const PatchId anchor : anchors) places.push_back(place_around(map, anchor, {}, options));
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
    way_ = {};
    sighted_.clear();
    found_.reset();
    query_.reset();
    decided_.reset();
    since_utime_ = utime;
  }
  if (way_.newest_first.empty() || way_.newest_first.front() != robot_.place->last_patch) note_patch(options);
}

void Finder::note_patch(const EngineOptions& options) {
  const PatchId patch = robot_.place->last_patch;
  const Manifold& manifold = sketch_.manifold();
  Pose moved;
  if (!way_.newest_first.empty()) moved = manifold.relative_pose(way_.newest_first.front(), patch);
  way_.add(patch, std::hypot(moved.x, moved.y), options.hypotheses.max_piece_way_m);
  due_ = way_.length_m() >= options.finder.min_piece_way_m;
}

std::int64_t Finder::step(const Map& map, const std::vector<RigidPiece>& places, const EngineOptions& options,
                          FinderCounts& counts) {
  if (!query_) {
    begin(places, options);
    ++counts.queries;
  }
  const SearchTerms terms = terms_of(options.finder);
  if (const PlaceCandidate* next = query_->next()) {
    ++counts.places_searched;
    const auto place = std::ranges::find(places, next->anchor,
                                         [](const RigidPiece& piece) { return piece.local.reference; });
    return query_->search_next(*place, terms, options);
  }
  const PlaceDecision decision = query_->decide(map, terms, options);
  decided_ = decision.ambiguous ? NotFound::ambiguous : NotFound::fits_nowhere;
  if (decision.ambiguous) ++counts.ambiguous;
  if (decision.find && decision.find->probability() >= options.finder.min_find_probability) {
    ++counts.finds;
    decided_ = NotFound::found_once;
    take(map, *decision.find, options);
  }
  query_.reset();
  return decision.price_us;
}

void Finder::begin(const std::vector<RigidPiece>& places, const EngineOptions& options) {
  due_ = false;
  const double half_m = options.place_candidates.spacing_m;
  std::vector<PlaceCandidate> anywhere;
  for (const RigidPiece& place : places)
    anywhere.push_back({place.local.reference, {Pose{}, half_m, half_m, std::numbers::pi}});
  query_.emplace(std::move(anywhere));
  const std::vector<PatchId> way(way_.newest_first.begin(), way_.newest_first.end());
  query_->look_for(piece_of_way(sketch_, way, options.place_search));
}

// One find may be of another place that looks alike: it takes two, of two pieces of the way, that agree.
void Finder::take(const Map& map, const Find& find, const EngineOptions& options) {
  Sighted sighted;
  sighted.query = find.query;
  sighted.newest = query_->piece().local.reference;
  sighted.pose = {find.anchor, find.anchor_from_query};
  sighted.map_from_sketch =
      map.manifold().project(sighted.pose) * inverse(sketch_.manifold().pose(find.query));
  sighted.island = map.graph().island(find.anchor);
  const Pose here = sketch_from_robot();
  const Pose& newest = sketch_.manifold().pose(sighted.newest);
  const bool agreed = std::ranges::any_of(sighted_, [&](const Sighted& other) {
    const Pose off = ominus(other.map_from_sketch * here, sighted.map_from_sketch * here);
    const Pose& its = sketch_.manifold().pose(other.newest);
    return other.island == sighted.island && options.common.is_within(off, options.common.agreeing_m) &&
           std::hypot(its.x - newest.x, its.y - newest.y) >= options.common.baseline_m;
  });
  if (agreed) found_ = sighted;
  sighted_.push_back(sighted);
  if (sighted_.size() > options.common.max_finds) sighted_.pop_front();
}

NotFound Finder::why(const FinderOptions& options) const {
  if (decided_) return *decided_;
  return way_.length_m() < options.min_piece_way_m ? NotFound::way_too_short : NotFound::searching;
}

std::optional<ManifoldPose> Finder::take_found() {
  if (!found_) return std::nullopt;
  const Sighted found = *std::exchange(found_, std::nullopt);
  sighted_.clear();  // should it prove false, they are
  const ManifoldPose seen_from_query =
      sketch_.manifold().transform(robot_.place->pose, found.query);  // eq. 3
  return ManifoldPose{found.pose.patch, found.pose.patch_from_object * seen_from_query.patch_from_object};
}

}  // namespace isthmus
