// An input between communication points.
#pragma once

#include "members.hpp"

namespace zspring {

// value + rate tau + 1/2 curvature tau^2, tau since the last communication point.
struct Signal {
  double value = 0;
  double rate = 0;
  double curvature = 0;
  bool has_derivatives = false;  // rate or curvature were given: `value` belongs to the begin of the step
  bool has_curvature = false;

  double at(double tau) const { return value + tau * (rate + 0.5 * curvature * tau); }
  double rate_at(double tau) const { return rate + tau * curvature; }
  double integral(double tau) const { return tau * (value + tau * (rate / 2 + tau * curvature / 6)); }

  // Over a step of `length` s, from where it was: without derivatives the value is a target, reached at the end in
  // a straight line. Linear in `last` and the values, so that it also serves variations.
  Signal from(double last, double length) const {
    return has_derivatives ? *this : Signal{last, (value - last) / length};
  }
};
ZSPRING_MEMBERS(Signal, value, rate, curvature, has_derivatives, has_curvature)

}  // namespace zspring
