#include <openssl/evp.h>

#include <array>
#include <bit>
#include <memory>
#include <stdexcept>
#include <string_view>

#include "server/engine/record/map_copy.hpp"

namespace isthmus {
namespace {

/// Feeds values to SHA-256 in one fixed form: little-endian 64-bit words, texts with their length before
/// them.
class Digest {
 public:
  Digest() : context_(EVP_MD_CTX_new(), &EVP_MD_CTX_free) {
    if (!context_ || EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) != 1) {
      throw std::runtime_error("SHA-256 is not available from OpenSSL");
    }
  }

  void add(std::int64_t value) {
    auto bits = static_cast<std::uint64_t>(value);
    std::array<unsigned char, 8> bytes{};
    for (unsigned char& byte : bytes) {
      byte = static_cast<unsigned char>(bits & 0xff);
      bits >>= 8;
    }
    bytes_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (bytes_.size() >= block) update();
  }
  void add(double value) { add(std::bit_cast<std::int64_t>(value)); }
  void add(std::string_view text) {
    add(static_cast<std::int64_t>(text.size()));
    bytes_.append(text);
  }
  void add(const Pose& pose) {
    add(pose.x);
    add(pose.y);
    add(pose.yaw);
  }
  template <class Tag>
  void add(Id<Tag> id) {
    add(std::int64_t{id.value});
  }
  template <class Derived>
  void add(const Eigen::MatrixBase<Derived>& matrix) {
    for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
      for (Eigen::Index column = 0; column < matrix.cols(); ++column) add(double{matrix(row, column)});
    }
  }

  std::string hex() {
    update();
    std::array<unsigned char, EVP_MAX_MD_SIZE> hash{};
    unsigned int length = 0;
    EVP_DigestFinal_ex(context_.get(), hash.data(), &length);
    std::string text;
    for (unsigned int i = 0; i < length; ++i) {
      text += "0123456789abcdef"[hash[i] >> 4];
      text += "0123456789abcdef"[hash[i] & 0xf];
    }
    return text;
  }

 private:
  static constexpr std::size_t block = 1 << 16;

  void update() {
    EVP_DigestUpdate(context_.get(), bytes_.data(), bytes_.size());
    bytes_.clear();
  }

  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
  std::string bytes_;
};

void add_patch(Digest& digest, const Patch& patch, const Pose& map_from_patch) {
  digest.add(patch.id);
  digest.add(std::string_view(patch.robot));
  digest.add(patch.utime);
  digest.add(patch.laser.robot_from_laser);
  digest.add(patch.laser.range_min_m);
  digest.add(patch.laser.range_max_m);
  digest.add(patch.scan.utime);
  digest.add(patch.scan.bearing0_rad);
  digest.add(patch.scan.bearing_step_rad);
  digest.add(static_cast<std::int64_t>(patch.scan.ranges_m.size()));
  for (const float range_m : patch.scan.ranges_m) digest.add(double{range_m});
  digest.add(map_from_patch);
}

struct AddMeasurement {
  Digest& digest;

  void operator()(const Correspondences& measurement) const {
    digest.add(measurement.form.r);
    digest.add(std::int64_t{measurement.count});
  }
  void operator()(const RelativePose& measurement) const {
    digest.add(measurement.a_from_b);
    digest.add(measurement.information);
  }
  void operator()(const Range& measurement) const {
    digest.add(measurement.point_a);
    digest.add(measurement.point_b);
    digest.add(measurement.range_m);
    digest.add(measurement.sigma_m);
  }
  void operator()(const Bearing& measurement) const {
    digest.add(measurement.a_from_observer);
    digest.add(measurement.point_b);
    digest.add(measurement.bearing_rad);
    digest.add(measurement.sigma_rad);
  }
};

void add_relation(Digest& digest, const Relation& relation) {
  digest.add(relation.a);
  digest.add(relation.b);
  digest.add(name(relation.kind));
  digest.add(name(relation.origin.kind));
  digest.add(relation.origin.closure);
  digest.add(relation.robust_scale);
  digest.add(static_cast<std::int64_t>(relation.measurement.index()));
  std::visit(AddMeasurement{digest}, relation.measurement);
}

void add_annotation(Digest& digest, const AnnotationRecord& annotation) {
  digest.add(word(annotation.kind));
  digest.add(std::string_view(annotation.name));
  digest.add(annotation.max_speed_m_s);
  digest.add(static_cast<std::int64_t>(annotation.points.size()));
  for (const ManifoldPose& point : annotation.points) {
    digest.add(point.patch);
    digest.add(point.patch_from_object);
  }
}

}  // namespace

std::string map_sha256(const MapCopy& map) {
  Digest digest;
  digest.add(static_cast<std::int64_t>(map.patches.size()));
  for (std::size_t i = 0; i < map.patches.size(); ++i) add_patch(digest, *map.patches[i], map.poses[i]);

  // In order of id; the ids themselves only count how often the engine changed its mind.
  digest.add(static_cast<std::int64_t>(map.graph.relations().size()));
  for (const auto& [id, relation] : map.graph.relations()) add_relation(digest, relation);

  // A refused or withdrawn closure has left nothing in the map, so it leaves nothing here.
  for (const ClosureRecord& closure : map.closures) {
    if (closure.state != ClosureState::accepted) continue;
    digest.add(closure.id);
    digest.add(word(closure.kind));
    digest.add(closure.utime);
  }

  // Patches that operators have dropped are still there, but no part of what is exported.
  if (!map.left_out.empty()) {
    digest.add(std::string_view("left_out"));
    for (const PatchId patch : map.left_out) digest.add(patch);
  }
  // Robots drive by places and zones: with others it is another map to them.
  if (!map.annotations.empty()) digest.add(std::string_view("annotations"));
  for (const AnnotationRecord& annotation : map.annotations) add_annotation(digest, annotation);
  return digest.hex();
}

}  // namespace isthmus
