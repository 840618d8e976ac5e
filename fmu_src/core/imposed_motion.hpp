// A position given at communication points (imposed head, wire height), made a motion in between.
//
// Without derivatives the value is a target: the position moves to it in a straight line and arrives at the end
// of the step, so that it never jumps. Velocity and acceleration at the communication points then come from
// HHT's own relations between position, velocity and acceleration, read backwards: second order, and stable for
// sampled data of any kind.
//
// With derivatives the position follows value + rate tau + curvature tau^2/2; what separates its begin from where
// the position was is closed in a straight line. For the reported acceleration and reaction the curvature goes on
// with the slope it had since the communication point before: held, it would give the inertia force of the begin
// of the step at its end.
#pragma once

#include "parameters.hpp"
#include "state.hpp"

namespace zspring {

// At the last communication point.
struct MotionState {
  double position = 0;          // m
  double velocity = 0;          // m/s
  double acceleration = 0;      // m/s2
  double acceleration_hht = 0;  // m/s2, HHT's memory, of hht_alpha times the last step's length later
  double curvature = 0;         // m/s2, as given for the last step
  double curvature_length = 0;  // s, of that step; 0 where no curvature was given
};

template <class Visitor>
void visit(MotionState& m, Visitor&& f) {
  f(m.position), f(m.velocity), f(m.acceleration), f(m.acceleration_hht), f(m.curvature), f(m.curvature_length);
}

// The motion over one communication step of `length` s. Linear in the start's motion and the input's values, so
// that it also serves as its own derivative: give it variations and it returns the variation.
class ImposedMotion {
 public:
  ImposedMotion(const MotionState& start, const Signal& input, double length, double hht_alpha);

  void at(double tau, Boundary& b) const;  // sets position, velocity, acceleration; 0 <= tau <= length
  const MotionState& end() const { return end_; }

 private:
  MotionState start_, end_;
  Signal input_;
  double length_;
  double gap_ = 0;   // m, from the input to where the position was
  double jerk_ = 0;  // m/s3
};

}  // namespace zspring
