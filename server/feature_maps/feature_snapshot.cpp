// Maps of features as bytes: all that a FeatureEstimator is, but for its options.

#include <algorithm>
#include <stdexcept>

#include "server/engine/snapshot/snapshot_values.hpp"
#include "server/feature_maps/feature_estimator.hpp"

namespace isthmus {
namespace {

bool is_index(int index, std::size_t size) { return index >= 0 && static_cast<std::size_t>(index) < size; }

}  // namespace

template <class Archive>
void serialize(Archive& archive, Feature& feature) {
  archive(feature.kind, feature.a, feature.b, feature.radius_m, feature.opening_rad, feature.end_a_known,
          feature.end_b_known, feature.heading_known, feature.radius_known);
  if (feature.kind > FeatureKind::pole) throw std::runtime_error("it holds a value that there is not");
}

template <class Matrix>
void save_matrix(SnapshotWriter& writer, const Matrix& matrix) {
  writer(static_cast<std::uint64_t>(matrix.rows()), static_cast<std::uint64_t>(matrix.cols()));
  writer.write(matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof(double));
}

template <class Matrix>
void load_matrix(SnapshotReader& reader, Matrix& matrix) {
  std::uint64_t rows = 0, columns = 0;
  reader(rows, columns);
  const std::uint64_t most = reader.bytes_left() / sizeof(double);
  if (rows > most || columns > most || (rows > 0 && columns > most / rows))
    throw std::runtime_error("it counts more than it holds");
  matrix.resize(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
  reader.read(matrix.data(), static_cast<std::size_t>(rows * columns) * sizeof(double));
}

void save(SnapshotWriter& writer, const FeatureState& state) {
  writer(state.form, state.robots, state.features, state.next_id, state.marks);
  save_matrix(writer, state.covariance);
  save_matrix(writer, state.told.transpose());
}

void load(SnapshotReader& reader, FeatureState& state) {
  Eigen::RowVectorXd told;
  reader(state.form, state.robots, state.features, state.next_id, state.marks);
  load_matrix(reader, state.covariance);
  load_matrix(reader, told);
  state.told = told.transpose();
  if (state.form > FilterForm::printed || !is_sound(state))
    throw std::runtime_error("a state of its map is not one");
}

void save(SnapshotWriter& writer, const FeaturesAside& aside) {
  writer(aside.features);
  save_matrix(writer, aside.covariance);
  save_matrix(writer, aside.with_rest);
}

void load(SnapshotReader& reader, FeaturesAside& aside) {
  reader(aside.features);
  load_matrix(reader, aside.covariance);
  load_matrix(reader, aside.with_rest);
}

void save(SnapshotWriter& writer, const ObservedFeature& seen) {
  Feature feature = seen.feature;
  writer(feature, static_cast<std::uint8_t>(seen.covariance.rows()));
  writer.write(seen.covariance.data(), static_cast<std::size_t>(seen.covariance.size()) * sizeof(double));
}

void load(SnapshotReader& reader, ObservedFeature& seen) {
  std::uint8_t rows = 0;
  reader(seen.feature, rows);
  if (rows > 4) throw std::runtime_error("it holds a value that there is not");
  seen.covariance.resize(rows, rows);
  reader.read(seen.covariance.data(), static_cast<std::size_t>(seen.covariance.size()) * sizeof(double));
}

/// They are the configuration's.
void save(SnapshotWriter&, const FeatureMapOptions&) {}
void load(SnapshotReader&, FeatureMapOptions&) {}

void save(SnapshotWriter& writer, const FeatureFilter& filter) {
  FeatureFilter copy = filter;
  std::apply([&](auto&... changing) { writer(changing...); }, copy.changing());
}

void load(SnapshotReader& reader, FeatureFilter& filter) {
  std::apply([&](auto&... changing) { reader(changing...); }, filter.changing());
  if (!filter.holds_together()) throw std::runtime_error("a state of its map is not one");
}

/// What scans are placed on is made again of the places' scans.
void save(SnapshotWriter& writer, const ScanTracker& tracker) {
  ScanTracker copy = tracker;
  std::apply([&](auto&... members) { writer(members...); }, copy.changing());
}

void load(SnapshotReader& reader, ScanTracker& tracker) {
  std::apply([&](auto&... members) { reader(members...); }, tracker.changing());
}

/// What inputs and waiting are: of these kinds.
void save(SnapshotWriter& writer, const Event& event) {
  writer(event.receive_utime, static_cast<std::uint8_t>(event.body.index()));
  std::visit(
      [&](const auto& body) {
        if constexpr (requires { const_cast<std::decay_t<decltype(body)>&>(body).members(); })
          writer(body);
        else
          throw std::logic_error("an event was to be saved that makes no map");
      },
      event.body);
}

template <class Body>
void load_body(SnapshotReader& reader, Event& event) {
  reader(event.body.emplace<Body>());
}

void load(SnapshotReader& reader, Event& event) {
  std::uint8_t kind = 0;
  reader(event.receive_utime, kind);
  const auto is_a = [&](const auto& body) { return kind == decltype(event.body)(body).index(); };
  if (is_a(RobotEvent())) return load_body<RobotEvent>(reader, event);
  if (is_a(TagEvent())) return load_body<TagEvent>(reader, event);
  if (is_a(ScanEvent())) return load_body<ScanEvent>(reader, event);
  if (is_a(SightingEvent())) return load_body<SightingEvent>(reader, event);
  throw std::runtime_error("it holds an event that makes no map");
}

void save(SnapshotWriter& writer, const std::shared_ptr<const Event>& event) {
  writer(event != nullptr);
  if (event) writer(*event);
}

void load(SnapshotReader& reader, std::shared_ptr<const Event>& event) {
  bool is_there = false;
  reader(is_there);
  if (!is_there) return event.reset();
  auto read = std::make_shared<Event>();
  reader(*read);
  event = std::move(read);
}

bool MapInput::is_sound() const {
  const auto is = [&]<class Body>(const Body*) { return event && std::holds_alternative<Body>(event->body); };
  switch (kind) {
    case MapInputKind::declared:
      return is(static_cast<const RobotEvent*>(nullptr));
    case MapInputKind::tag:
      return is(static_cast<const TagEvent*>(nullptr));
    case MapInputKind::scanned:
      return is(static_cast<const ScanEvent*>(nullptr));
    case MapInputKind::sighted:
      return is(static_cast<const SightingEvent*>(nullptr));
    case MapInputKind::begun:
    case MapInputKind::moved:
      return !event;
  }
  return false;
}

bool FeatureMapper::is_sound() const {
  const auto is_journey = [&](int number) { return is_index(number, journeys_.size()); };
  const auto is_known = [&](const std::string& name) { return robots_.contains(name); };
  for (const auto& [barcode, name] : wearers_)
    if (!is_known(name)) return false;
  for (const auto& [name, robot] : robots_)
    if (robot.journey != -1 && !is_journey(robot.journey)) return false;
  for (const Team& team : teams_)
    if (!std::all_of(team.journeys.begin(), team.journeys.end(), is_journey)) return false;
  for (const Journey& journey : journeys_) {
    if (!is_known(journey.robot) || !is_index(journey.team, teams_.size())) return false;
    const Team& team = teams_[static_cast<std::size_t>(journey.team)];
    if (team.journeys.empty() || !is_index(journey.member, team.filter.state().robots.size())) return false;
  }
  const auto is_heard = [&](const Heard& heard) {
    return is_journey(heard.observer) && is_journey(heard.target) && heard.row < sightings_.size();
  };
  const auto has_mark = [&](int team, int id) {
    if (!is_index(team, teams_.size())) return false;
    const std::vector<MarkInState>& marks = teams_[static_cast<std::size_t>(team)].filter.state().marks;
    return std::ranges::find(marks, id, &MarkInState::id) != marks.end();
  };
  for (const auto& [maps, meeting] : open_)
    if (!has_mark(maps.first, meeting.mark_1) || !has_mark(maps.second, meeting.mark_2) ||
        !fusions_.contains(meeting.fusion))
      return false;
  const auto has_begun = [&](int number) {
    return is_journey(number) && !journeys_[static_cast<std::size_t>(number)].rows.empty();
  };
  for (const auto& [id, fusion] : fusions_)
    if (fusion.placing && (!has_begun(fusion.placing->journey_1) || !has_begun(fusion.placing->journey_2)))
      return false;
  return told_.is_sound() && told_.size() == sightings_.size() &&
         std::all_of(heard_.begin(), heard_.end(), is_heard) &&
         std::all_of(moved_.begin(), moved_.end(), is_known);
}

void FeatureMapper::keep_options() {
  for (auto& [name, robot] : robots_) robot.tracker.restore(options_.engine);
  for (Team& team : teams_) {
    FeatureFilter filter(options_.filter);
    filter.changing() = team.filter.changing();
    team.filter = std::move(filter);
  }
}

std::vector<std::uint8_t> FeatureEstimator::save() const {
  SnapshotWriter writer;
  writer(configuration_.toml, mapper_, inputs_, forbidden_, dropped_until_, withdrawn_, events_, dropped_,
         dropped_by_robot_);
  return writer.take();
}

FeatureEstimator FeatureEstimator::restore(FeatureMapKind kind, std::span<const std::uint8_t> saved) {
  FeatureEstimator estimator(feature_map_options(kind));
  SnapshotReader reader(saved);
  std::string toml;
  reader(toml);
  auto configuration = parse_configuration(toml, "its configuration");
  if (const std::string* error = std::get_if<std::string>(&configuration)) throw std::runtime_error(*error);
  estimator.configuration_ = std::get<Configuration>(std::move(configuration));
  estimator.options_.any_tag = estimator.configuration_.any_tag;
  estimator.mapper_ = FeatureMapper(estimator.options_);
  reader(estimator.mapper_, estimator.inputs_, estimator.forbidden_, estimator.dropped_until_,
         estimator.withdrawn_, estimator.events_, estimator.dropped_, estimator.dropped_by_robot_);
  if (reader.bytes_left() > 0) throw std::runtime_error("it does not end where it should");
  estimator.mapper_.keep_options();
  return estimator;
}

}  // namespace isthmus
