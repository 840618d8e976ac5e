#include "imposed_motion.hpp"

namespace zspring {

ImposedMotion::ImposedMotion(const MotionState& start, const Signal& input, double length, double hht_alpha)
    : start_(start), input_(input), length_(length) {
  const double H = length;
  if (input.has_curvature) {
    gap_ = start.position - input.value;
    // A slope seen over a short step tells nothing of a much longer one.
    if (start.curvature_length > 0.5 * H) jerk_ = (input.curvature - start.curvature) / start.curvature_length;
    Boundary b;
    at(H, b);
    const double acceleration = b.acceleration + b.acceleration_change;
    end_ = {b.position, b.velocity, acceleration, acceleration + hht_alpha * H * jerk_, input.curvature, H};
    return;
  }
  const double beta = 0.25 * (1 - hht_alpha) * (1 - hht_alpha);
  const double gamma = 0.5 - hht_alpha;
  end_.position = input.has_rate ? input.at(H) : input.value;
  end_.acceleration_hht = (end_.position - start.position - H * start.velocity) / (beta * H * H) -
                          (0.5 - beta) / beta * start.acceleration_hht;
  end_.velocity = start.velocity + H * ((1 - gamma) * start.acceleration_hht + gamma * end_.acceleration_hht);
  // HHT's acceleration is the weighted one of both ends; undo the weighting.
  end_.acceleration = (end_.acceleration_hht + hht_alpha * start.acceleration) / (1 + hht_alpha);
}

void ImposedMotion::at(double tau, Boundary& b) const {
  const double x = tau / length_;
  if (input_.has_curvature) {
    b.position = input_.at(tau) + (1 - x) * gap_;
    b.velocity = input_.rate + tau * input_.curvature - gap_ / length_;
    b.acceleration = input_.curvature;
    b.acceleration_change = tau * jerk_;
  } else {
    b.position = start_.position + x * (end_.position - start_.position);
    b.velocity = start_.velocity + x * (end_.velocity - start_.velocity);
    b.acceleration = start_.acceleration + x * (end_.acceleration - start_.acceleration);
  }
}

}  // namespace zspring
