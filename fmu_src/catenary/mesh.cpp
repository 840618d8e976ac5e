#include "mesh.hpp"

#include <algorithm>
#include <cmath>

namespace zspring::catenary {

Mesh::Mesh(const LineTable& line, double longest_element) {
  std::vector<double> places;
  for (const Support& s : line.supports) places.push_back(s.x);
  for (const Dropper& d : line.droppers) places.push_back(d.x);
  for (const StitchWire& s : line.stitches) places.insert(places.end(), {s.begin, s.end});
  for (const PointMass& m : line.masses) places.push_back(m.x);
  std::sort(places.begin(), places.end());
  x.push_back(0);
  for (double end : places) {
    const double begin = x.back();
    if (end == begin) continue;
    const int elements = std::max(1, static_cast<int>(std::ceil((end - begin) / longest_element - 1e-9)));
    for (int i = 1; i < elements; ++i) x.push_back(begin + (end - begin) * i / elements);
    x.push_back(end);
  }
  is_stitched.assign(x.size(), 0);
  for (const StitchWire& s : line.stitches)
    std::fill(is_stitched.begin() + station_at(s.begin), is_stitched.begin() + station_at(s.end), 1);
  for (const Support& s : line.supports) supports.push_back(station_at(s.x));
  for (const Dropper& d : line.droppers) {
    const int station = station_at(d.x);
    droppers.push_back(station);
    upper.push_back(d.on_stitch != 0 ? stitch_deflection(station) : deflection(station, Messenger));
  }
}

int Mesh::station_at(double place) const {
  return static_cast<int>(std::lower_bound(x.begin(), x.end(), place) - x.begin());
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
  place.share = s;
  place.begin_is_held = place.station == 0;
  place.end_is_held = place.station + 2 == stations();
  return place;
}

double Mesh::upper_deflection(const VectorXd& all, const Place& at, bool of_stitch) const {
  const int i = deflection(at.station, Messenger);
  if (at.value.isZero(0)) return 0;  // outside the line
  if (!is_stitched[at.station]) return at.value.dot(Eigen::Vector4d(all[i], all[i + 1], all[i + 4], all[i + 5]));
  const auto end = [&](int station) {
    return all[of_stitch && has_stitch(station) ? stitch_deflection(station) : deflection(station, Messenger)];
  };
  return (1 - at.share) * end(at.station) + at.share * end(at.station + 1);
}

}  // namespace zspring::catenary
