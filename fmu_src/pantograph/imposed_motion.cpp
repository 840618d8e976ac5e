#include "imposed_motion.hpp"

#include <algorithm>

namespace zspring {

MotionState MotionState::variation() const {
  MotionState d;
  d.positions = positions;
  d.curvatures = curvatures;
  d.closing = closing;
  std::fill_n(d.positions.value, Positions::most, 0.0);
  std::fill_n(d.positions.missed, Positions::most, 0.0);
  std::fill_n(d.curvatures.value, Curvatures::most, 0.0);
  return d;
}

ImposedMotion::ImposedMotion(const MotionState& start, const Signal& input, double length, double resolved)
    : start_(start), end_(start), input_(input), length_(length), closing_(length) {
  if (length < start.closing / 16) closing_ = start.closing;
  end_.position = position(length);
  end_.closing = closing_ > length ? closing_ - length : length;
  Positions& reached = end_.positions;
  const double told = input.has_derivatives ? length : 0;
  if (start.positions.count == 0)
    for (int i = 0; i + 1 < Positions::dense; ++i) reached.append(length, start.position, resolved, told);
  else if (input.has_derivatives)
    reached.begin_at(input.value);
  reached.append(length, input.has_derivatives ? input.at(length) : end_.position, resolved, told);

  if (input.has_curvature) {
    Curvatures& given = end_.curvatures;
    given.append(start.positions.last_length, input.curvature, resolved);
    // What was seen over short steps tells nothing of the end of a much longer one.
    const Interpolant path(given, length / 2, 3);
    if (path.has_older()) curvature_change_ = path.value(length) - input.curvature;
    Boundary b;
    at(length, b);
    end_.velocity = b.velocity;
    end_.acceleration = b.acceleration + b.acceleration_change;
  } else {
    const Interpolant path(reached, reached.closest);
    end_.velocity = path.slope();
    end_.acceleration = path.curvature();
    end_.curvatures.count = 0;
  }
}

double ImposedMotion::position(double tau) const {
  if (!input_.has_derivatives) return start_.position + tau / length_ * (input_.value - start_.position);
  return input_.at(tau) + (1 - tau / closing_) * (start_.position - input_.value);
}

void ImposedMotion::at(double tau, Boundary& b) const {
  const double x = tau / length_;
  b.position = position(tau);
  if (input_.has_curvature) {
    b.velocity = input_.rate + tau * input_.curvature - (start_.position - input_.value) / closing_;
    b.acceleration = input_.curvature;
    b.acceleration_change = x * curvature_change_;
  } else {
    b.velocity = start_.velocity + x * (end_.velocity - start_.velocity);
    b.acceleration = start_.acceleration + x * (end_.acceleration - start_.acceleration);
    b.acceleration_change = 0;
  }
}

}  // namespace zspring
