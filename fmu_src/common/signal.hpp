// An input between communication points, and what a model throws: shared by the models and the FMI layer.
#pragma once

#include <stdexcept>

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

// Parameters that make no model: the message names the variable, its value and what is allowed.
class ParameterError : public std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

// Why a communication step was not made.
struct AdvanceFailure {
  double time = 0;      // s since the begin of the communication step
  char text[256] = "";  // for the log
};

}  // namespace zspring
