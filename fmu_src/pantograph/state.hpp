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
ZSPRING_MEMBERS(Boundary, uplift, contact_force, position, velocity, acceleration, acceleration_change)

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
ZSPRING_MEMBERS(MechanicalState, q, v, a, a_slope, h, internal, s, contact_force, dissipated, work, loss_power,
                boundary, statistics)

}  // namespace zspring
