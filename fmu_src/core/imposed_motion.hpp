// A position given at communication points (imposed head, wire height), made a motion in between.
//
// Without derivatives the value is a target: the position moves to it in a straight line and arrives at the end
// of the step, so that it never jumps. With derivatives it follows value + rate tau + curvature tau^2/2; what
// separates the begin of that from where the position was is closed in a straight line.
//
// Velocity and acceleration at the communication points come from HHT's own relations between position, velocity
// and acceleration, read backwards: second order, and stable for sampled data of any kind. Derivatives as given
// belong to the begin of the step and say less of its end, where the reaction is reported.
#pragma once

#include "parameters.hpp"
#include "state.hpp"

namespace zspring {

// At the last communication point.
struct MotionState {
  double position = 0;          // m
  double velocity = 0;          // m/s
  double acceleration = 0;      // m/s2
  double acceleration_hht = 0;  // m/s2, HHT's memory, of hht_alpha times `length` later
  double slope = 0;             // m/s3, of acceleration_hht
  double length = 0;            // s, of the last step
};

template <class Visitor>
void visit(MotionState& m, Visitor&& f) {
  f(m.position), f(m.velocity), f(m.acceleration), f(m.acceleration_hht), f(m.slope), f(m.length);
}

// The motion over one communication step of `length` s. Linear in the start's motion and the input's values, so
// that it also serves as its own derivative: give it variations and it returns the variation.
class ImposedMotion {
 public:
  ImposedMotion(const MotionState& start, const Signal& input, double length, double hht_alpha);

  void at(double tau, Boundary& b) const;  // sets position, velocity, acceleration; 0 <= tau <= length
  const MotionState& end() const { return end_; }

 private:
  double position(double tau) const;

  MotionState start_, end_;
  Signal input_;
  double length_;
};

}  // namespace zspring
