// Free space out of hostile scans, rings of hostile points, and set operations on both: nothing may escape,
// abort or come out unsound.

#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "patches/manifold.hpp"
#include "tests/support/solids.hpp"

namespace isthmus {
namespace {

// Values read off the front of the input; zeros once it is used up.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

  bool empty() const { return size_ == 0; }

  template <class Value>
  Value take() {
    Value value{};
    const std::size_t count = std::min(sizeof value, size_);
    if (count > 0) std::memcpy(&value, data_, count);
    data_ += count;
    size_ -= count;
    return value;
  }

  // Mostly a plain number of a few metres, at times any bit pattern.
  double number() {
    const auto kind = take<std::uint8_t>();
    if (kind >= 0xF0) return take<double>();
    if (kind >= 0xE0) return static_cast<double>(take<float>());
    return take<std::int16_t>() / (kind < 0x80 ? 2048.0 : 1.0);
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
};

Scan take_scan(Bytes& bytes) {
  Scan scan;
  scan.bearing0_rad = bytes.number();
  scan.bearing_step_rad = bytes.number() / 16;
  const std::size_t beams = bytes.take<std::uint8_t>() % 64U;
  for (std::size_t i = 0; i < beams; ++i) scan.ranges_m.push_back(static_cast<float>(bytes.number()));
  return scan;
}

Ring take_ring(Bytes& bytes) {
  Ring ring;
  const std::size_t points = bytes.take<std::uint8_t>() % 16U;
  for (std::size_t i = 0; i < points; ++i) {
    const double x = bytes.number();
    ring.emplace_back(x, bytes.number());
  }
  return ring;
}

Pose take_pose(Bytes& bytes) {
  const double x = bytes.number();
  const double y = bytes.number();
  return {x, y, bytes.number()};
}

PatchPtr take_patch(Bytes& bytes) {
  Laser laser;
  laser.robot_from_laser = take_pose(bytes);
  laser.range_min_m = bytes.number();
  laser.range_max_m = bytes.number();
  PatchOptions options;
  options.free_space.no_return_range_m = bytes.number();
  options.free_space.outline.simplify_tolerance_m = bytes.number() / 16;
  return make_patch(PatchId{0}, "R1", take_scan(bytes), laser, options);
}

Polysolid take_solid(Bytes& bytes) {
  const auto kind = bytes.take<std::uint8_t>();
  if (kind % 4 == 0) {
    Ring outer = take_ring(bytes);
    Ring hole = take_ring(bytes);
    std::vector<PolygonWithHoles> polygons{{std::move(outer), {std::move(hole)}}, {take_ring(bytes), {}}};
    return kind % 8 == 0 ? Polysolid(std::move(polygons)) : Polysolid::of_sound(std::move(polygons));
  }
  const PatchPtr patch = take_patch(bytes);
  patch->star.contains({bytes.number(), 1});
  patch->index.nearest({bytes.number(), 1});
  return transformed(take_pose(bytes), patch->free_space);
}

void require(bool condition) {
  if (!condition) std::abort();
}

void require_sound(const Polysolid& solid) {
  for (const PolygonWithHoles& polygon : solid.polygons()) {
    require(is_simple(polygon.outer) && signed_area_m2(polygon.outer) > 0);
    for (const Ring& hole : polygon.holes) require(is_simple(hole) && signed_area_m2(hole) < 0);
  }
}

void run(Bytes bytes) {
  const Polysolid a = take_solid(bytes);
  const Polysolid b = take_solid(bytes);
  const Polysolid repaired_a(a.polygons());
  const Polysolid both = testing::united({a, b});
  require_sound(repaired_a);
  require_sound(both);
  overlap(a, b);
  contains(both, {bytes.number(), bytes.number()});
  to_wkt(both, 3);
}

}  // namespace
}  // namespace isthmus

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  isthmus::run({data, size});
  return 0;
}
