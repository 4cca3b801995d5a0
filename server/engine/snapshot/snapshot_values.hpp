#pragma once

#include <algorithm>
#include <cereal/types/array.hpp>
#include <cereal/types/complex.hpp>
#include <cereal/types/deque.hpp>
#include <cereal/types/map.hpp>
#include <cereal/types/memory.hpp>
#include <cereal/types/optional.hpp>
#include <cereal/types/set.hpp>
#include <cereal/types/string.hpp>
#include <cereal/types/utility.hpp>
#include <cereal/types/variant.hpp>
#include <cereal/types/vector.hpp>
#include <future>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>

#include "relations/chunked_vector.hpp"
#include "relations/relation.hpp"
#include "server/engine/input/words.hpp"
#include "server/engine/map/fit_job.hpp"
#include "server/engine/snapshot/snapshot_archive.hpp"

namespace isthmus {

template <class Value>
concept ListsMembers = requires(Value& value) {
  value.members();
};

/// The size of an object that has these members, in this order, and no others.
template <class... Members>
constexpr std::size_t size_with(std::type_identity<std::tuple<Members&...>>) {
  std::size_t end = 0;
  std::size_t alignment = 1;
  const auto up = [](std::size_t size, std::size_t unit) { return (size + unit - 1) / unit * unit; };
  ((end = up(end, alignof(Members)) + sizeof(Members), alignment = std::max(alignment, alignof(Members))),
   ...);
  return up(end, alignment);
}

/// An enumeration's values are those that have words.
template <class Value>
void check_value(const Value& value) {
  if constexpr (HasWords<Value>)
    if (!has_word(value)) throw std::runtime_error("it holds a value that there is not");
}

template <class Archive, ListsMembers Value>
void serialize(Archive& archive, Value& value) {
  using Members = decltype(value.members());
  static_assert(size_with(std::type_identity<Members>{}) == sizeof(Value),
                "members() must list all members, in their order");
  std::apply([&](auto&... members) { archive(members...); }, value.members());
  if constexpr (std::is_same_v<Archive, SnapshotReader>)
    std::apply([](const auto&... members) { (check_value(members), ...); }, value.members());
  if constexpr (std::is_same_v<Archive, SnapshotReader> && requires { value.is_sound(); })
    if (!value.is_sound()) throw std::runtime_error("its map is not one");
}

/// Counters hold the words of what they count: a new reason changes no snapshot.
template <HasWords Enum>
void save(SnapshotWriter& writer, const std::map<Enum, std::int64_t>& counts) {
  writer(by_word(counts));
}

template <HasWords Enum>
void load(SnapshotReader& reader, std::map<Enum, std::int64_t>& counts) {
  std::map<std::string, std::int64_t> counts_by_word;
  reader(counts_by_word);
  counts.clear();
  for (const auto& [text, count] : counts_by_word) {
    const std::optional<Enum> value = value_of<Enum>(text);
    if (!value) throw std::runtime_error("it counts by a reason that there is not");
    counts.emplace(*value, count);
  }
}

template <class Archive, class Tag>
void serialize(Archive& archive, Id<Tag>& id) {
  archive(id.value);
  if constexpr (std::is_same_v<Archive, SnapshotReader> && std::is_same_v<Id<Tag>, PatchId>) {
    const auto end = static_cast<std::int64_t>(archive.context.patches.size());
    if (id.value < -1 || id.value > end) throw std::runtime_error("it names a patch that it lacks");
  }
}

/// As a std::vector.
template <class Archive, class T, std::size_t chunk_size>
void save(Archive& archive, const ChunkedVector<T, chunk_size>& values) {
  archive(cereal::make_size_tag(static_cast<cereal::size_type>(values.size())));
  for (std::size_t i = 0; i < values.size(); ++i) archive(values[i]);
}

template <class Archive, class T, std::size_t chunk_size>
void load(Archive& archive, ChunkedVector<T, chunk_size>& values) {
  std::vector<T> read;
  archive(read);
  values = {};
  for (T& value : read) values.push_back(std::move(value));
}

template <class Archive>
void serialize(Archive& archive, Pose& pose) {
  archive(pose.x, pose.y, pose.yaw);
}

template <class Archive>
void serialize(Archive& archive, ManifoldPose& pose) {
  archive(pose.patch, pose.patch_from_object);
}

template <class Archive, int rows, int columns>
void serialize(Archive& archive, Eigen::Matrix<double, rows, columns>& matrix) {
  static_assert(rows > 0 && columns > 0);
  for (double& element : matrix.reshaped()) archive(element);
}

template <class Archive>
void serialize(Archive& archive, Laser& laser) {
  archive(laser.robot_from_laser, laser.range_min_m, laser.range_max_m);
}

template <class Archive>
void serialize(Archive& archive, Scan& scan) {
  archive(scan.utime, scan.bearing0_rad, scan.bearing_step_rad, scan.ranges_m);
}

template <class Archive>
void serialize(Archive& archive, ScanPoint& point) {
  archive(point.position, point.normal, point.beam);
}

template <class Archive>
void serialize(Archive& archive, PolygonWithHoles& polygon) {
  archive(polygon.outer, polygon.holes);
}

template <class Archive>
void serialize(Archive& archive, Origin& origin) {
  archive(origin.kind, origin.closure, origin.sighting);
}

template <class Archive>
void serialize(Archive& archive, QuadraticForm& form) {
  archive(form.r);
}

template <class Archive>
void serialize(Archive& archive, QuadraticForm::Minimum& minimum) {
  archive(minimum.a_from_b, minimum.cost);
}

template <class Archive>
void serialize(Archive& archive, Correspondences& correspondences) {
  archive(correspondences.form, correspondences.count, correspondences.least);
}

template <class Archive>
void serialize(Archive& archive, RelativePose& pose) {
  archive(pose.a_from_b, pose.information);
}

template <class Archive>
void serialize(Archive& archive, Range& range) {
  archive(range.point_a, range.point_b, range.range_m, range.sigma_m);
}

template <class Archive>
void serialize(Archive& archive, Bearing& bearing) {
  archive(bearing.a_from_observer, bearing.point_b, bearing.bearing_rad, bearing.sigma_rad);
}

template <class Archive>
void serialize(Archive& archive, Relation& relation) {
  archive(relation.id, relation.a, relation.b, relation.kind, relation.measurement, relation.origin,
          relation.robust_scale);
}

/// They are the configuration's.
inline void save(SnapshotWriter&, const EngineOptions&) {}
inline void load(SnapshotReader& reader, EngineOptions& options) { options = reader.context.options; }

inline void save(SnapshotWriter&, const AbandonedFits&) {}
inline void load(SnapshotReader&, AbandonedFits&) {}

/// The result of a job, waited for.
template <class Value>
void save(SnapshotWriter& writer, const std::shared_future<Value>& result) {
  writer(result.get());
}

template <class Value>
void load(SnapshotReader& reader, std::shared_future<Value>& result) {
  std::promise<Value> promise;
  Value value;
  reader(value);
  promise.set_value(std::move(value));
  result = promise.get_future().share();
}

void save(SnapshotWriter& writer, const PatchPtr& patch);
void load(SnapshotReader& reader, PatchPtr& patch);

}  // namespace isthmus
