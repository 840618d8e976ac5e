// An input between communication points, and what a model throws: shared by the models and the FMI layer.
#pragma once

#include <cstddef>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <type_traits>

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

// Of a struct of nothing but doubles: a model's outputs.
template <class Outputs>
bool all_finite(const Outputs& y) {
  static_assert(std::is_trivially_copyable_v<Outputs> && sizeof(Outputs) % sizeof(double) == 0);
  double x, sum = 0;
  for (std::size_t i = 0; i < sizeof y; i += sizeof x) {
    std::memcpy(&x, reinterpret_cast<const char*>(&y) + i, sizeof x);
    sum += x - x;
  }
  return sum == 0;
}

inline constexpr char overflow[] = "values overflow: parameters or inputs are too large or too small";

// Why a communication step was not made.
struct AdvanceFailure {
  double time = 0;      // s since the begin of the communication step
  char text[256] = "";  // for the log
  bool at_end = false;  // the run can go no further
};

// A communication step of more internal steps would take hours: its length is a mistake.
inline bool too_long(double length, double internal_step, AdvanceFailure& failure) {
  if (length <= 1e9 * internal_step) return false;
  failure.time = 0;
  std::snprintf(failure.text, sizeof failure.text,
                "communicationStepSize = %.10g s: must be at most 1e9 internal steps, of %.3g s", length,
                internal_step);
  return true;
}

}  // namespace zspring
