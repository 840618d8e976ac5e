// The overhead line, linearised about its unloaded static shape, and all that changes in a simulation step.
#pragma once

#include "common/statistics.hpp"
#include "static_shape.hpp"
#include "sweeps.hpp"

namespace zspring::catenary {

// Displacements u are measured from the unloaded static shape. With all droppers pulling,
//
//   M u'' + C u' + K u = forces,   C = damping_mass M + damping_stiffness K_wires
struct Line {
  Line(const Parameters& parameters, LineTable built);  // refers to the parameters

  // Forces of supports, steady arms and droppers that pull, times `factor`.
  void add_springs(double factor, const VectorXd& u, VectorXd& forces) const;
  SparseMatrix stiffness() const;  // K
  // A place with the irregularity there, for the contact wire's course.
  Place at(double position) const {
    Place place = mesh.at(position);
    if (mesh.contains(position)) place.irregularity = table.irregularity(position);
    return place;
  }
  // The contact wire's over the datum at a place, which a pantograph meets.
  Irregularity course(const VectorXd& u, const Place& at) const {
    const Eigen::Vector4d nodes = at.of(u) + at.of(shape.height);
    const Irregularity& more = at.irregularity;
    return {at.value.dot(nodes) + more.height, at.slope.dot(nodes) + more.slope,
            at.curvature.dot(nodes) + more.curvature};
  }

  const Parameters& p;
  LineTable table;
  Mesh mesh;
  Matrices matrices;
  StaticShape shape;
};

// A contact force on the contact wire, at one place.
struct PointLoad {
  Place place;
  Eigen::Vector4d value = Eigen::Vector4d::Zero();  // N, N m: force times place.value
};

struct Loads {
  PointLoad on[pantographs];

  void add_to(VectorXd& x, double factor) const {
    for (const PointLoad& l : on) l.place.add(factor * l.value, x);
  }
  bool operator==(const Loads& other) const {
    for (int i = 0; i < pantographs; ++i)
      if (on[i].place.station != other.on[i].place.station || on[i].value != other.on[i].value) return false;
    return true;
  }
  double dot(const VectorXd& x) const {
    double sum = 0;
    for (const PointLoad& l : on) sum += l.value.dot(l.place.of(x));
    return sum;
  }
};

// Position, speed and force of a pantograph at a communication point.
struct Passage {
  double position = 0;  // m
  double speed = 0;     // m/s
  double force = 0;     // N
};
ZSPRING_MEMBERS(Passage, position, speed, force)

struct LineState {
  VectorXd u, v;          // m and 1, m/s and 1/s
  VectorXd a;             // HHT's memory, common/hht.hpp
  VectorXd a_slope;       // its rate
  VectorXd internal;      // N and N m: C v + K u + slack droppers - contact forces
  VectorXd damping;       // N and N m: C v
  VectorXd slack;         // m, of the droppers
  double h = 0;           // s, of the last step; 0 before the first
  double loss_power = 0;  // W, of the damping; known where the energies are
  // J; elastic from the unloaded static state
  double kinetic = 0, elastic = 0, dissipated = 0, work = 0;
  Passage passage[pantographs];
  Statistics statistics;

  static LineState at_rest(const Line& line);  // unloaded; also a variation of nothing
};
ZSPRING_MEMBERS(LineState, u, v, a, a_slope, internal, damping, slack, h, loss_power, kinetic, elastic, dissipated,
                work, passage, statistics)

// How a state varies with something that acts at one place: within a step that is felt at a few stations alone.
struct Variation {
  LineState d;
  Range on{0, 0};  // stations; outside of them d is zero

  static Variation of_nothing(const Line& line) { return {LineState::at_rest(line)}; }
  void clear();
  void take_over(const Variation& other);          // after clear()
  void add_to(LineState& s, double factor) const;  // s += factor d, but for energies, passages and statistics
};

}  // namespace zspring::catenary
