#include "tools/evaluate/landmark_maps.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <ctime>
#include <map>
#include <numbers>

#include "relations/fit.hpp"
#include "server/features/feature_filter.hpp"
#include "tools/evaluate/alignment.hpp"
#include "tools/text/lines.hpp"

namespace isthmus {
namespace {

double cpu_since(std::clock_t start) { return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC; }

FilterOptions options_for(FilterForm form, LandmarkAssociation association) {
  FilterOptions options;
  options.form = form;
  options.tentative.confirm_after = 1;  // nothing in these logs is clutter
  if (association == LandmarkAssociation::nearest) options.association.pairing = Pairing::nearest;
  return options;
}

/// Which feature each landmark's sightings were taken for, and which landmark began each feature.
struct Bookkeeping {
  std::vector<std::map<int, int>> votes;  ///< by landmark: sightings by feature
  std::map<int, int> began;               ///< landmark by feature
  std::size_t wrong = 0;

  void note(int landmark, int feature) {
    ++votes[static_cast<std::size_t>(landmark)][feature];
    if (began.try_emplace(feature, landmark).first->second != landmark) ++wrong;
  }
  int feature_of(std::size_t landmark) const {
    int best = -1, most = 0;
    for (const auto& [feature, count] : votes[landmark]) {
      if (count <= most) continue;
      best = feature;
      most = count;
    }
    return best;
  }
};

std::vector<ObservedFeature> as_features(const LandmarkStep& step) {
  std::vector<ObservedFeature> seen;
  for (const LandmarkSighting& s : step.sightings) seen.push_back({point_feature(s.place), s.covariance});
  return seen;
}

void observe(FeatureFilter& filter, const LandmarkStep& step, LandmarkAssociation association,
             Bookkeeping& books) {
  const std::vector<ObservedFeature> seen = as_features(step);
  const auto landmark = [&](std::size_t i) { return step.sightings[i].landmark; };
  if (association == LandmarkAssociation::known) {
    std::vector<int> ids;
    for (const LandmarkSighting& s : step.sightings)
      ids.push_back(books.feature_of(static_cast<std::size_t>(s.landmark)));
    const std::vector<int> used = filter.observe_known(0, seen, ids);
    for (std::size_t i = 0; i < used.size(); ++i)
      if (used[i] >= 0) books.note(landmark(i), used[i]);
    return;
  }
  const FeatureScanOutcome outcome = filter.observe(0, seen);
  for (const FeatureScanOutcome::Pair& pair : outcome.paired) books.note(landmark(pair.seen), pair.id);
  for (const FeatureScanOutcome::Pair& pair : outcome.added) books.note(landmark(pair.seen), pair.id);
}

PatchId patch(std::size_t index) { return {static_cast<std::int32_t>(index)}; }

Relation odometry_relation(std::size_t to, const LandmarkStep& step) {
  Relation relation;
  relation.a = patch(to - 1);
  relation.b = patch(to);
  relation.kind = RelationKind::odometry;
  relation.origin.kind = OriginKind::odometry;
  relation.measurement = RelativePose{step.old_from_new, step.covariance.inverse()};
  return relation;
}

/// Two rows whose squares sum to the squared distance over its covariance.
Relation sighting_relation(std::size_t from, std::size_t landmark_patch, const LandmarkSighting& seen) {
  const Eigen::Matrix2d root = seen.covariance.inverse().llt().matrixU();
  QuadraticFormBuilder builder;
  for (int k = 0; k < 2; ++k) {
    const Eigen::Vector2d row = root.row(k);
    builder.point_on_line(Eigen::Vector2d::Zero(), seen.place, row.normalized(), 1 / row.norm());
  }
  Relation relation;
  relation.a = patch(from);
  relation.b = patch(landmark_patch);
  relation.kind = RelationKind::point_to_point;
  relation.origin.kind = OriginKind::sighting;
  relation.measurement = Correspondences{builder.build(), 1, {}};
  return relation;
}

/// The log as relations, from a map to start at.
struct LandmarkGraph {
  RelationGraph graph;
  std::vector<Pose> poses;
  std::size_t degrees_of_freedom = 0;
};
LandmarkGraph graph_of(const LandmarkLog& log, const LandmarkMap& start) {
  LandmarkGraph result;
  const std::size_t count = log.steps.size();
  for (std::size_t i = 0; i < count + log.landmark_ids.size(); ++i) result.graph.add_patch(patch(i));
  result.poses = start.poses;
  for (const auto& place : start.landmarks) {
    const Eigen::Vector2d there = place.value_or(Eigen::Vector2d::Zero());
    result.poses.push_back({there.x(), there.y(), 0});
  }
  std::size_t sightings = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (i > 0) result.graph.add(odometry_relation(i, log.steps[i]));
    for (const LandmarkSighting& seen : log.steps[i].sightings)
      result.graph.add(sighting_relation(i, count + static_cast<std::size_t>(seen.landmark), seen));
    sightings += log.steps[i].sightings.size();
  }
  result.degrees_of_freedom = 2 * sightings - std::min(2 * sightings, 2 * log.landmark_ids.size());
  return result;
}

double chi_squared_of(const LandmarkGraph& input) {
  double sum = 0;
  for (const auto& [id, relation] : input.graph.relations()) {
    const Pose& a = input.poses[static_cast<std::size_t>(relation.a.value)];
    const Pose& b = input.poses[static_cast<std::size_t>(relation.b.value)];
    sum += 2 * cost(relation.measurement, ominus(b, a));
  }
  return sum;
}

void check_same(const LandmarkLog& log, const LandmarkLog& exact, const std::string& file) {
  if (log.steps.size() != exact.steps.size() || log.landmark_ids != exact.landmark_ids)
    throw FileError(file, 0, "not of the poses and landmarks of the log");
}

void add_fresh_noise(const LandmarkLog& exact, const LandmarkTruth& truth, LandmarkAssociation association,
                     std::size_t noises, LandmarkEvaluation& evaluation) {
  evaluation.noises = noises;
  if (noises == 0) return;
  for (const FilterForm form : {FilterForm::invariant, FilterForm::printed}) {
    LandmarkEvaluation::FreshNoise mean{form == FilterForm::invariant ? "invariant" : "printed", 0, 0, 0};
    for (std::size_t seed = 1; seed <= noises; ++seed) {
      const LandmarkErrors errors =
          landmark_errors(filter_landmarks(with_noise(exact, seed), form, association, &truth), truth);
      const auto share = 1 / static_cast<double>(noises);
      mean.nees_per_dof += share * errors.nees_per_dof;
      mean.pose_rmse_m += share * errors.pose_rmse_m;
      mean.pose_rmse_deg += share * errors.pose_rmse_deg;
    }
    evaluation.fresh.push_back(mean);
  }
}

}  // namespace

LandmarkMap filter_landmarks(const LandmarkLog& log, FilterForm form, LandmarkAssociation association,
                             const LandmarkTruth* truth) {
  LandmarkMap map;
  FeatureFilter filter(options_for(form, association));
  filter.add_robot({}, Eigen::Matrix3d::Zero());
  Bookkeeping books;
  books.votes.resize(log.landmark_ids.size());
  const std::clock_t start = std::clock();
  for (std::size_t i = 0; i < log.steps.size(); ++i) {
    if (i > 0) filter.move(0, log.steps[i].old_from_new, log.steps[i].covariance);
    if (!log.steps[i].sightings.empty()) observe(filter, log.steps[i], association, books);
    map.poses.push_back(filter.state().robots[0].map_from_robot);
    if (truth != nullptr) map.nees.push_back(pose_nees(filter.state(), 0, truth->poses[i]) / 3);
  }
  map.cpu_s = cpu_since(start);
  for (std::size_t landmark = 0; landmark < log.landmark_ids.size(); ++landmark) {
    const std::optional<std::size_t> index = index_of(filter.state(), books.feature_of(landmark));
    map.landmarks.push_back(index ? std::optional(filter.state().features[*index].feature.a) : std::nullopt);
  }
  map.features = filter.state().features.size();
  map.wrong_pairs = books.wrong;
  return map;
}

LandmarkMap fit_landmarks(const LandmarkLog& log, const LandmarkMap& start_map) {
  LandmarkMap map;
  const std::clock_t start = std::clock();
  LandmarkGraph input = graph_of(log, start_map);
  FitOptions options;
  options.max_iterations = 200;
  const FitReport report = fit_island(input.graph, patch(0), input.poses, options);
  if (!report.ok) map.failure = report.message;
  map.cpu_s = cpu_since(start);
  map.chi_squared_per_dof =
      chi_squared_of(input) / static_cast<double>(std::max<std::size_t>(1, input.degrees_of_freedom));
  const auto count = static_cast<std::ptrdiff_t>(log.steps.size());
  map.poses.assign(input.poses.begin(), input.poses.begin() + count);
  for (auto pose = input.poses.begin() + count; pose != input.poses.end(); ++pose)
    map.landmarks.emplace_back(position(*pose));
  return map;
}

LandmarkErrors landmark_errors(const LandmarkMap& map, const LandmarkTruth& truth) {
  LandmarkErrors errors;
  for (std::size_t i = 0; i < map.poses.size(); ++i) {
    const Eigen::Vector3d off = wrapped_difference(map.poses[i], truth.poses[i]);
    errors.pose_rmse_m += off.head<2>().squaredNorm();
    errors.pose_rmse_deg += off.z() * off.z();
  }
  const auto poses = static_cast<double>(map.poses.size());
  errors.pose_rmse_m = std::sqrt(errors.pose_rmse_m / poses);
  errors.pose_rmse_deg = std::sqrt(errors.pose_rmse_deg / poses) * 180 / std::numbers::pi;
  for (const double nees : map.nees) errors.nees_per_dof += nees / poses;
  std::vector<PosePair> pairs;
  for (std::size_t i = 0; i < map.landmarks.size(); ++i) {
    if (!map.landmarks[i]) continue;
    const Eigen::Vector2d there = truth.landmarks[i], here = *map.landmarks[i];
    pairs.push_back({{there.x(), there.y(), 0}, {here.x(), here.y(), 0}});
  }
  errors.landmarks = pairs.size();
  if (pairs.empty()) return errors;
  const Pose truth_from_map = align(pairs);
  for (const PosePair& pair : pairs) {
    const Eigen::Vector2d there = position(pair.truth_from_robot), here = position(pair.map_from_robot);
    errors.landmark_rmse_m += (there - here).squaredNorm();
    errors.landmark_aligned_m += (there - truth_from_map * here).squaredNorm();
  }
  errors.landmark_rmse_m = std::sqrt(errors.landmark_rmse_m / static_cast<double>(pairs.size()));
  errors.landmark_aligned_m = std::sqrt(errors.landmark_aligned_m / static_cast<double>(pairs.size()));
  return errors;
}

LandmarkEvaluation evaluate_landmarks(const LandmarkArguments& arguments) {
  const LandmarkLog log = read_landmark_log(arguments.file);
  LandmarkEvaluation evaluation;
  evaluation.poses = log.steps.size();
  evaluation.landmarks = log.landmark_ids.size();
  for (const LandmarkStep& step : log.steps) evaluation.sightings += step.sightings.size();
  std::optional<LandmarkLog> exact;
  std::optional<LandmarkTruth> truth;
  if (!arguments.truth.empty()) {
    exact = read_landmark_log(arguments.truth);
    check_same(log, *exact, arguments.truth);
    truth = true_map(*exact);
  }
  const LandmarkTruth* known_truth = truth ? &*truth : nullptr;
  for (const FilterForm form : {FilterForm::invariant, FilterForm::printed})
    evaluation.rows.push_back({form == FilterForm::invariant ? "invariant" : "printed",
                               filter_landmarks(log, form, arguments.association, known_truth),
                               {}});
  const bool known = arguments.association == LandmarkAssociation::known;
  const LandmarkMap start =
      known ? evaluation.rows.front().map
            : filter_landmarks(log, FilterForm::invariant, LandmarkAssociation::known, nullptr);
  evaluation.rows.push_back({"batch", fit_landmarks(log, start), {}});
  evaluation.against_batch = !truth.has_value();
  if (!truth) {
    truth.emplace().poses = evaluation.rows.back().map.poses;
    for (const auto& place : evaluation.rows.back().map.landmarks) truth->landmarks.push_back(*place);
  }
  for (LandmarkEvaluation::Row& row : evaluation.rows) row.errors = landmark_errors(row.map, *truth);
  if (exact) add_fresh_noise(*exact, *truth, arguments.association, arguments.noises, evaluation);
  return evaluation;
}

}  // namespace isthmus
