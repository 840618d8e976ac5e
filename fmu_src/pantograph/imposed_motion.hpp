// A position given at communication points (imposed head, wire height), made a motion in between.
//
// Without derivatives the value is a target: the position moves to it in a straight line and arrives at the end
// of the step, so that it never jumps. Velocity and acceleration at communication points are those of a polynomial
// through the last five, or older ones where steps are uneven (samples.hpp).
//
// With derivatives the position follows value + rate tau + curvature tau^2/2; what separates the begin of that
// from where the position was is closed in a straight line, within the step, or over a much longer one before it, whose
// end it comes from. Velocity and acceleration follow it where the
// curvature is given. That belongs to the begin of the step: for the acceleration and the reaction that are
// reported at its end it is continued from its last three values, else they would be those of one step earlier.
#pragma once

#include "parameters.hpp"
#include "samples.hpp"
#include "state.hpp"

namespace zspring {

// At the last communication point.
struct MotionState {
  double position = 0;      // m
  double velocity = 0;      // m/s
  double acceleration = 0;  // m/s2
  Positions positions;      // empty before the first step: at rest until then
  Curvatures curvatures;    // as given for the last steps, at their begin
  double closing = 0;       // s, in which a short step is to close what is left of a gap

  MotionState variation() const;  // of a motion that does not vary
};
ZSPRING_MEMBERS(MotionState, position, velocity, acceleration, positions, curvatures, closing)

// The motion over one communication step of `length` s. Linear in the start's motion and the input's values, so
// that it also serves as its own derivative: give it variations and it returns the variation.
class ImposedMotion {
 public:
  // `start` must outlive it. Samples closer than `resolved` s are not told apart where steps are uneven.
  ImposedMotion(const MotionState& start, const Signal& input, double length, double resolved);

  void at(double tau, Boundary& b) const;  // sets the motion in `b`; 0 <= tau <= length
  const MotionState& end() const { return end_; }

 private:
  double position(double tau) const;

  const MotionState& start_;
  MotionState end_;
  Signal input_;
  double length_;
  double closing_;               // s, over which the gap is closed
  double curvature_change_ = 0;  // m/s2, over the step
};

}  // namespace zspring
