#pragma once

#include <string>
#include <vector>

#include "patches/ring.hpp"
#include "patches/scan.hpp"

namespace isthmus {

struct PolygonWithHoles {
  Ring outer;               ///< counter-clockwise
  std::vector<Ring> holes;  ///< clockwise
};

/// Free space as a polysolid (Howard et al. 2006, III-A, footnote 1): a set of disjoint polygons with holes.
/// A plain value; CGAL's exact polygon sets work behind it.
/// Rings are simple; polygons and holes may touch one another, within rounding, at points. Every function
/// takes any polysolid, also an empty one, and none throws or aborts on degenerate rings (repeated points,
/// spikes, self-intersections, non-finite coordinates): those are repaired or dropped.
class Polysolid {
 public:
  Polysolid() = default;
  /// The union of the polygons, each repaired: non-finite and repeated points and spikes go, rings are
  /// oriented, what a ring encloses is told by the even-odd rule, holes are taken from their own polygon
  /// only, and rings without area (see min_ring_area_m2) or hopelessly tangled are dropped.
  explicit Polysolid(std::vector<PolygonWithHoles> polygons);
  /// Takes polygons that are as polygons() promises; nothing is checked.
  static Polysolid of_sound(std::vector<PolygonWithHoles> polygons);

  const std::vector<PolygonWithHoles>& polygons() const { return polygons_; }
  bool empty() const { return polygons_.empty(); }

 private:
  std::vector<PolygonWithHoles> polygons_;
};

struct OutlineOptions {
  double min_free_m = 0.01;
  double simplify_tolerance_m = 0.03;
  double closing_beams = 1.5;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(min_free_m, "min_free_m", "m",
           "of a beam: shorter ones open nothing, their ends are one point with the laser");
    option(simplify_tolerance_m, "simplify_tolerance_m", "m",
           "by which the simplified outline may differ: about 3 sigma of range noise");
    option(closing_beams, "closing_beams", "factor",
           "on the angle between beams: where the last and the first are nearer they are neighbours");
  }
};

struct FreeSpaceOptions {
  double max_range_m = 20;       ///< beams are cut here
  double no_return_range_m = 0;  ///< a beam without return opens free space this far (0: none)
  OutlineOptions outline;
};

/// The free space seen by a scan, in the robot's frame: the star polygon of its beams, simplified. A scan of
/// less than a full turn includes the laser's own position. Free is what lies between two neighbouring usable
/// beams: an ignored beam, or one that opens nothing, closes the wedges on both its sides, so that there may
/// be several polygons, which touch at the laser. Empty for a scan without two neighbouring usable beams.
Polysolid free_space_of(const Scan& scan, const Laser& laser, const FreeSpaceOptions& options);

bool overlap(const Polysolid& a, const Polysolid& b);

bool contains(const Polysolid& solid, const Eigen::Vector2d& point);
Polysolid transformed(const Pose& a_from_b, const Polysolid& solid_b);

/// "MULTIPOLYGON (((x y, ...)))", with `decimals` after the point; "MULTIPOLYGON EMPTY" for none.
std::string to_wkt(const Polysolid& solid, int decimals = 3);

}  // namespace isthmus
