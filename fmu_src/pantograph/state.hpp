// Everything that changes in a simulation step: copied to go back, written out to be restored bit for bit.
#pragma once

#include "common/statistics.hpp"
#include "mechanics.hpp"

namespace zspring {

// What the surroundings do at one instant.
struct Boundary {
  Eigen::Vector3d uplift = Eigen::Vector3d::Zero();  // N, on u1, u2, u3
  double contact_force = 0;                          // N, Drive::Force
  double position = 0;                               // m, of the imposed head or the wire
  double velocity = 0;                               // m/s
  double acceleration = 0;                           // m/s2
  // By how much the acceleration has probably changed since the communication point, m/s2: reported with it and
  // with the reaction; the motion itself is the one that was told.
  double acceleration_change = 0;
};

struct MechanicalState {
  Vector5 q = Vector5::Zero();
  Vector5 v = Vector5::Zero();
  Vector5 a = Vector5::Zero();  // HHT's memory, common/hht.hpp
  Vector5 a_slope = Vector5::Zero();
  double h = 0;                        // s, of the last step; 0 before the first
  Vector5 internal = Vector5::Zero();  // C v + Fe(q) + Ff(v) - P
  Vector2 s = Vector2::Zero();         // friction moment / moment_bound
  double contact_force = 0;            // N, the force that acts, in every drive
  double dissipated = 0;               // J since the start
  double work = 0;                     // J since the start
  double loss_power = 0;               // W
  Boundary boundary;                   // at this instant, as the last step saw it
  Statistics statistics;
};

template <class Visitor>
void visit(Boundary& b, Visitor&& f) {
  f(b.uplift), f(b.contact_force), f(b.position), f(b.velocity), f(b.acceleration), f(b.acceleration_change);
}

template <class Visitor>
void visit(MechanicalState& s, Visitor&& f) {
  f(s.q), f(s.v), f(s.a), f(s.a_slope), f(s.h), f(s.internal), f(s.s), f(s.contact_force), f(s.dissipated),
      f(s.work), f(s.loss_power);
  visit(s.boundary, f);
  visit(s.statistics, f);
}

}  // namespace zspring
