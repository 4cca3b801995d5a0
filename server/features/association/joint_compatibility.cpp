#include <algorithm>
#include <optional>

#include "server/features/association/association.hpp"
#include "server/features/association/joint_factor.hpp"

namespace isthmus {
namespace {

/// The search through the interpretation tree: one level for each observation, fewest candidates first.
class Search {
 public:
  Search(const Eigen::MatrixXd& covariance, std::span<const Candidate> all, const AssociationOptions& options,
         const Gates& gates)
      : covariance_(covariance), all_(all), max_steps_(options.max_steps), gates_(gates) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (i == 0 || all[i].seen != all[i - 1].seen) levels_.emplace_back();
      levels_.back().push_back(i);
    }
    std::stable_sort(levels_.begin(), levels_.end(),
                     [](const auto& a, const auto& b) { return a.size() < b.size(); });
    cross_.resize(all.size() * all.size());
  }

  std::vector<std::size_t> run() {
    descend(0, 0);
    std::sort(best_.begin(), best_.end());
    return best_;
  }

 private:
  void descend(std::size_t level, double distance) {
    if (chosen_.size() > best_.size() || (chosen_.size() == best_.size() && distance < best_distance_)) {
      best_ = chosen_;
      best_distance_ = distance;
    }
    if (level == levels_.size() || ++steps_ > max_steps_) return;
    for (const std::size_t next : levels_[level]) {
      if (is_taken(all_[next].index) || !can_beat_best(level, distance, 0)) continue;
      const std::optional<double> joint = append(next, distance);
      if (!joint) continue;
      descend(level + 1, *joint);
      joint_.pop();
      chosen_.pop_back();
    }
    if (can_beat_best(level, distance, 1)) descend(level + 1, distance);
  }

  /// With all further levels paired but so many.
  bool can_beat_best(std::size_t level, double distance, std::size_t unpaired) const {
    const std::size_t most = chosen_.size() + levels_.size() - level - unpaired;
    return most > best_.size() || (most == best_.size() && distance < best_distance_);
  }

  bool is_taken(std::size_t index) const {
    return std::any_of(chosen_.begin(), chosen_.end(), [&](std::size_t c) { return all_[c].index == index; });
  }

  const LocalMatrix& cross(std::size_t a, std::size_t b) {
    std::optional<LocalMatrix>& known = cross_[a * all_.size() + b];
    if (!known) known = cross_covariance(covariance_, all_[a].measurement, all_[b].measurement);
    return *known;
  }

  /// The joint distance with one more pairing; nothing where the set is not compatible with it.
  std::optional<double> append(std::size_t next, double distance) {
    const LinearMeasurement& measurement = all_[next].measurement;
    const double bound = gates_(joint_.rows() + measurement.residual.size()) - distance;
    const LocalMatrix own = cross(next, next) + measurement.noise;
    const auto added =
        joint_.append(measurement.residual, own, bound,
                      [&](std::size_t k) -> const LocalMatrix& { return cross(next, chosen_[k]); });
    if (!added) return std::nullopt;
    chosen_.push_back(next);
    return distance + *added;
  }

  const Eigen::MatrixXd& covariance_;
  std::span<const Candidate> all_;
  std::size_t max_steps_;
  const Gates& gates_;
  std::vector<std::vector<std::size_t>> levels_;
  std::vector<std::optional<LocalMatrix>> cross_;
  JointFactor joint_;
  std::vector<std::size_t> chosen_, best_;
  double best_distance_ = 0;
  std::size_t steps_ = 0;
};

}  // namespace

std::vector<std::size_t> largest_compatible(const Eigen::MatrixXd& covariance, std::span<const Candidate> all,
                                            const AssociationOptions& options, const Gates& gates) {
  if (all.empty()) return {};
  return Search(covariance, all, options, gates).run();
}

}  // namespace isthmus
