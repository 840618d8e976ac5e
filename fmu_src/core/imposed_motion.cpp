#include "imposed_motion.hpp"

namespace zspring {

ImposedMotion::ImposedMotion(const MotionState& start, const Signal& input, double length, double hht_alpha)
    : start_(start), input_(input), length_(length) {
  const double H = length;
  const double beta = 0.25 * (1 - hht_alpha) * (1 - hht_alpha);
  const double gamma = 0.5 - hht_alpha;
  const double before = start.acceleration_hht + (start.length > 0 ? hht_alpha * (H - start.length) * start.slope : 0);
  const double after = (position(H) - start.position - H * start.velocity) / (beta * H * H) - (0.5 - beta) / beta * before;
  end_.position = position(H);
  end_.velocity = start.velocity + H * ((1 - gamma) * before + gamma * after);
  end_.acceleration_hht = after;
  end_.slope = slope_known(H, start.length) ? (after - before) / H : start.slope;
  end_.length = H;
  // HHT's acceleration is the weighted one of both ends; undo the weighting.
  end_.acceleration = (end_.acceleration_hht + hht_alpha * start.acceleration) / (1 + hht_alpha);
}

double ImposedMotion::position(double tau) const {
  const double x = tau / length_;
  if (!input_.has_derivatives) return start_.position + x * (input_.value - start_.position);
  return input_.at(tau) + (1 - x) * (start_.position - input_.value);
}

void ImposedMotion::at(double tau, Boundary& b) const {
  const double x = tau / length_;
  b.position = position(tau);
  b.velocity = start_.velocity + x * (end_.velocity - start_.velocity);
  b.acceleration = start_.acceleration + x * (end_.acceleration - start_.acceleration);
}

}  // namespace zspring
