#include "imposed_motion.hpp"

namespace zspring {

ImposedMotion::ImposedMotion(const MotionState& start, const Signal& input, double H, double hht_alpha)
    : start_(start), input_(input), H_(H) {
  end_.position = input.has_rate || input.has_curvature ? input.at(H) : input.value;
  if (input.has_curvature) {
    end_.velocity = input.rate + input.curvature * H + (input.value - start.position) / H;
    end_.acceleration = end_.acceleration_hht = input.curvature;
    return;
  }
  const double beta = 0.25 * (1 - hht_alpha) * (1 - hht_alpha);
  const double gamma = 0.5 - hht_alpha;
  end_.acceleration_hht = (end_.position - start.position - H * start.velocity) / (beta * H * H) -
                          (0.5 - beta) / beta * start.acceleration_hht;
  end_.velocity = start.velocity + H * ((1 - gamma) * start.acceleration_hht + gamma * end_.acceleration_hht);
  // HHT's acceleration is the weighted one of both ends; undo the weighting.
  end_.acceleration = (end_.acceleration_hht + hht_alpha * start.acceleration) / (1 + hht_alpha);
}

void ImposedMotion::at(double tau, Boundary& b) const {
  const double x = tau / H_;
  if (input_.has_curvature) {
    const double gap = start_.position - input_.value;
    b.position = input_.at(tau) + (1 - x) * gap;
    b.velocity = input_.rate + input_.curvature * tau - gap / H_;
    b.acceleration = input_.curvature;
  } else {
    b.position = start_.position + x * (end_.position - start_.position);
    b.velocity = start_.velocity + x * (end_.velocity - start_.velocity);
    b.acceleration = start_.acceleration + x * (end_.acceleration - start_.acceleration);
  }
}

}  // namespace zspring
