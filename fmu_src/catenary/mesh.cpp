#include "mesh.hpp"

#include <algorithm>
#include <cmath>

#include "common/failure.hpp"

namespace zspring::catenary {
namespace {

constexpr double least_distance = 0.001;  // m, of droppers and supports

void check_droppers(const Parameters& p) {
  double last = 0;
  for (int i = 0; i < p.dropper.count; ++i) {
    const double x = p.dropper.position[i];
    const double low = last + least_distance, high = p.line.span - least_distance;
    if (x < low || x > high)
      refuse(
          "dropper.position[%d] = %.10g m: must be at least %.10g m and at most %.10g m, after the dropper before "
          "it "
          "and within line.span = %.10g m",
          i + 1, x, low, high, p.line.span);
    last = x;
  }
}

}  // namespace

Mesh::Mesh(const Parameters& p) {
  check_droppers(p);
  const auto mesh_to = [&](double end) {
    const double begin = x.back();
    const int elements = std::max(1, static_cast<int>(std::ceil((end - begin) / p.mesh.element - 1e-9)));
    for (int i = 1; i < elements; ++i) x.push_back(begin + (end - begin) * i / elements);
    x.push_back(end);
    return stations() - 1;
  };
  x.push_back(0);
  supports.push_back(0);
  for (int span = 0; span < p.line.spans; ++span) {
    for (int i = 0; i < p.dropper.count; ++i) droppers.push_back(mesh_to(span * p.line.span + p.dropper.position[i]));
    supports.push_back(mesh_to((span + 1) * p.line.span));
  }
}

Place Mesh::at(double position) const {
  Place place;
  if (!contains(position)) return place;
  const auto after = std::upper_bound(x.begin() + 1, x.end() - 1, position);
  place.station = static_cast<int>(after - x.begin()) - 1;
  const double l = x[place.station + 1] - x[place.station];
  const double s = (position - x[place.station]) / l, r = 1 - s;
  place.value << r * r * (1 + 2 * s), l * s * r * r, s * s * (1 + 2 * r), -l * s * s * r;
  place.slope << -6 * s * r / l, r * (1 - 3 * s), 6 * s * r / l, s * (1 - 3 * r);
  place.curvature << (12 * s - 6) / (l * l), (6 * s - 4) / l, (6 - 12 * s) / (l * l), (6 * s - 2) / l;
  // The anchors do not move, whatever acts on them: there the wire answers with its slope only.
  if (place.station == 0) place.value[0] = place.slope[0] = place.curvature[0] = 0;
  if (place.station + 2 == stations()) place.value[2] = place.slope[2] = place.curvature[2] = 0;
  return place;
}

}  // namespace zspring::catenary
