// What the solver did since the start.
#pragma once

#include <algorithm>
#include <cstdint>

#include "members.hpp"

namespace zspring {

using Count = std::int64_t;

struct Statistics {
  Count steps = 0;           // internal steps made
  Count iterations = 0;      // in all attempts
  Count iterations_max = 0;  // of the worst one
  Count refinements = 0;     // halvings

  void add_attempt(int n) {
    iterations += n;
    iterations_max = std::max<Count>(iterations_max, n);
  }
  double iterations_per_step() const {
    return steps > 0 ? static_cast<double>(iterations) / static_cast<double>(steps) : 0;
  }
};
ZSPRING_MEMBERS(Statistics, steps, iterations, iterations_max, refinements)

}  // namespace zspring
