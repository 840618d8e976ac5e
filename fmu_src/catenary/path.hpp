// An input over one communication step of `length` s, from where it was.
#pragma once

#include "common/signal.hpp"

namespace zspring::catenary {

// Linear in `last` and the input's values, so that it also serves as its own derivative.
class Path {
 public:
  Path(double last, const Signal& input, double length) : s_(input) {
    // Without derivatives the value is a target, reached at the end of the step in a straight line.
    if (!input.has_derivatives) s_ = {last, (input.value - last) / length, 0, false, false};
  }

  double at(double tau) const { return s_.at(tau); }
  double rate(double tau) const { return s_.rate + tau * s_.curvature; }
  double integral(double tau) const { return tau * (s_.value + tau * (s_.rate / 2 + tau * s_.curvature / 6)); }

 private:
  Signal s_;
};

}  // namespace zspring::catenary
