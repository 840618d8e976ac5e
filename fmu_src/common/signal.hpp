// An input between communication points.
#pragma once

namespace zspring {

// value + rate tau + 1/2 curvature tau^2, tau since the last communication point.
struct Signal {
  double value = 0;
  double rate = 0;
  double curvature = 0;
  bool has_derivatives = false;  // rate or curvature were given: `value` belongs to the begin of the step
  bool has_curvature = false;

  double at(double tau) const { return value + tau * (rate + 0.5 * curvature * tau); }
};

template <class Visitor>
void visit(Signal& s, Visitor&& f) {
  f(s.value), f(s.rate), f(s.curvature), f(s.has_derivatives), f(s.has_curvature);
}

}  // namespace zspring
