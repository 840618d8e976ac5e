// A position given at communication points (imposed head, wire height), made a motion in between.
//
// Without derivatives the value is a target: the position moves to it in a straight line and arrives at the end
// of the step, so that it never jumps. Velocity and acceleration at the communication points then come from
// HHT's own relations between position, velocity and acceleration, read backwards: second order, and stable for
// sampled data of any kind. With derivatives the position follows the input's polynomial; what separates its
// begin from where the position was is closed in a straight line.
#pragma once

#include "parameters.hpp"
#include "state.hpp"

namespace zspring {

struct MotionState {
  double position = 0;           // m, at the last communication point
  double velocity = 0;           // m/s
  double acceleration = 0;       // m/s2
  double acceleration_hht = 0;   // m/s2, HHT's memory, of hht_alpha H after the last communication point
};

template <class Visitor>
void visit(MotionState& m, Visitor&& f) {
  f(m.position), f(m.velocity), f(m.acceleration), f(m.acceleration_hht);
}

// The motion over one communication step of length H, s. Linear in (start, input), so that it also serves as
// its own derivative: give it variations and it returns the variation.
class ImposedMotion {
 public:
  ImposedMotion(const MotionState& start, const Signal& input, double H, double hht_alpha);

  void at(double tau, Boundary& b) const;  // sets position, velocity, acceleration; 0 <= tau <= H
  const MotionState& end() const { return end_; }

 private:
  MotionState start_, end_;
  Signal input_;
  double H_;
};

}  // namespace zspring
