// Communication steps in internal ones.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "failure.hpp"
#include "statistics.hpp"

namespace zspring {

inline constexpr double rounding_of_time = 1e-6;  // of an internal step: hosts add up their communication points

// The fewest equal ones of at most `largest` s in `length` s.
inline Count internal_steps(double length, double largest) {
  return std::max<Count>(1, static_cast<Count>(std::ceil(length / largest - rounding_of_time)));
}

// Too short for anything to happen in it.
inline bool is_leftover(double length, double solver_step) { return length < rounding_of_time * solver_step; }

// More internal steps would take hours: such a length is a mistake.
inline std::optional<Discard> too_long(double length, double internal_step) {
  if (length <= 1e9 * internal_step) return std::nullopt;
  return Discard{
      0, text("communicationStepSize = %.10g s: must be at most 1e9 internal steps, of %.3g s", length, internal_step)};
}

}  // namespace zspring
