#include "imposed_motion.hpp"

#include <algorithm>

namespace zspring {

MotionState MotionState::variation() const {
  MotionState d;
  d.positions = positions;
  d.curvatures = curvatures;
  std::fill_n(d.positions.value, Samples::most, 0.0);
  std::fill_n(d.curvatures.value, Samples::most, 0.0);
  return d;
}

ImposedMotion::ImposedMotion(const MotionState& start, const Signal& input, double length)
    : start_(start), end_(start), input_(input), length_(length) {
  end_.position = position(length);
  if (start.positions.count == 0)
    for (int i = 0; i + 1 < Samples::most; ++i) end_.positions.append(length, start.position);
  end_.positions.append(length, end_.position);

  if (input.has_curvature) {
    Samples& given = end_.curvatures;
    given.append(start.positions.last_length, input.curvature);
    given.count = std::min<Count>(given.count, 3);
    // What was seen over short steps tells nothing of the end of a much longer one.
    if (given.count > 1 && length <= 2 * given.age[1])
      curvature_change_ = Interpolant(given).value(length) - input.curvature;
    Boundary b;
    at(length, b);
    end_.velocity = b.velocity;
    end_.acceleration = b.acceleration + b.acceleration_change;
  } else {
    const Interpolant path(end_.positions);
    end_.velocity = path.slope();
    end_.acceleration = path.curvature();
    end_.curvatures.count = 0;
  }
}

double ImposedMotion::position(double tau) const {
  const double x = tau / length_;
  if (!input_.has_derivatives) return start_.position + x * (input_.value - start_.position);
  return input_.at(tau) + (1 - x) * (start_.position - input_.value);
}

void ImposedMotion::at(double tau, Boundary& b) const {
  const double x = tau / length_;
  b.position = position(tau);
  if (input_.has_curvature) {
    b.velocity = input_.rate + tau * input_.curvature - (start_.position - input_.value) / length_;
    b.acceleration = input_.curvature;
    b.acceleration_change = x * curvature_change_;
  } else {
    b.velocity = start_.velocity + x * (end_.velocity - start_.velocity);
    b.acceleration = start_.acceleration + x * (end_.acceleration - start_.acceleration);
    b.acceleration_change = 0;
  }
}

}  // namespace zspring
