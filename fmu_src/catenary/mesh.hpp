// Stations along the line: places where the wires have a node, at supports, droppers, clamps, masses and between.
//
// Each station has four degrees of freedom: deflection and slope of contact wire and messenger. Between the clamps of a
// stitch wire messenger and stitch wire are strings without bending stiffness, and its deflection takes the place of
// the messenger's slope. Numbered along the line, so every matrix has a narrow band and its Cholesky factor no fill
// outside of it.
#pragma once

#include <cmath>
#include <vector>

#include "line_table.hpp"
#include "sparse.hpp"

namespace zspring::catenary {

inline int deflection(int station, Wire wire) { return 4 * station + 2 * wire; }
inline int slope(int station, Wire wire) { return deflection(station, wire) + 1; }
// Between the clamps of a stitch wire.
inline int stitch_deflection(int station) { return slope(station, Messenger); }

// Cubic Hermite functions of a beam element at a place: deflection there is value . (w, w' at both its ends).
struct Place {
  int station = 0;                                  // at the element's begin
  double share = 0;                                 // of the element, from there to the place
  bool begin_is_held = false, end_is_held = false;  // by an anchor
  Eigen::Vector4d value = Eigen::Vector4d::Zero();
  Eigen::Vector4d slope = Eigen::Vector4d::Zero();      // 1/m, d value / dx
  Eigen::Vector4d curvature = Eigen::Vector4d::Zero();  // 1/m2
  Irregularity irregularity;                            // where that counts: Line::at

  // The deflections and slopes of the contact wire at the element's ends, out of a vector of all.
  template <class Vector>
  Eigen::Vector4d of(const Vector& all) const {
    const int i = deflection(station, Contact);
    return {all[i], all[i + 1], all[i + 4], all[i + 5]};
  }
  // Of a load on the contact wire. The anchors do not move, whatever acts on them: there the wire answers with its
  // slope.
  template <class Vector>
  void add(const Eigen::Vector4d& load, Vector& all) const {
    const int i = deflection(station, Contact);
    if (!begin_is_held) all[i] += load[0];
    if (!end_is_held) all[i + 4] += load[2];
    all[i + 1] += load[1], all[i + 5] += load[3];
  }
};

class Mesh {
 public:
  Mesh(const LineTable& line, double longest_element);

  int stations() const { return static_cast<int>(x.size()); }
  int dofs() const { return 4 * stations(); }
  double length() const { return x.back(); }
  // Hosts add up positions: a place that rounding put beyond an end is at the end.
  bool contains(double position) const { return std::abs(2 * position - length()) <= (1 + 1e-9) * length(); }
  // All zero outside the line.
  Place at(double position) const;

  int station_at(double place) const;  // of one of the line's places
  // Whether the station is strictly between the clamps of a stitch wire.
  bool has_stitch(int station) const { return station > 0 && is_stitched[station - 1] && is_stitched[station]; }
  // Deflection of the messenger or, where there is one, the stitch wire out of a vector of all.
  double upper_deflection(const VectorXd& all, const Place& at, bool of_stitch) const;

  std::vector<double> x;          // m, of the stations
  std::vector<int> droppers;      // their stations, along the line
  std::vector<int> upper;         // degrees of freedom at the droppers' upper ends
  std::vector<int> supports;      // the stations at span boundaries, the anchors at both ends included
  std::vector<char> is_stitched;  // of the elements after each station but the last
};

}  // namespace zspring::catenary
