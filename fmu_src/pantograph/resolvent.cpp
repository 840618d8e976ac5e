#include "resolvent.hpp"

#include <algorithm>
#include <cmath>

namespace zspring {
namespace {

// The root y >= 0 of r y + tanh(y) = z, z >= 0, by Halley's method (third order) inside a bracket that holds it:
// tanh(y) <= 1 and tanh(y) <= y from below, tanh(y) >= 0 from above.
double positive_rate(double r, double z, double guess) {
  const double slipping = (z - 1) / r;
  if (slipping > 20) return slipping;  // tanh is 1 to the last bit
  double low = std::max(z / (1 + r), slipping);
  double high = z / r;
  double y = guess > low && guess < high ? guess : low;
  for (int i = 0; i < 100; ++i) {
    // With E = exp(2 y), D = E + 1: tanh = (E - 1)/D, its slope 4 E/D^2. One division in all; beyond 40 tanh is 1.
    const double E = std::exp(2 * std::min(y, 40.0)), D = E + 1;
    const double f = (r * y - z) * D + (E - 1);  // times D
    const double df = r * D * D + 4 * E;         // times D^2
    (f < 0 ? low : high) = y;
    const double step = -f * df * D / (df * df + 4 * f * (E - 1) * E);
    // Whatever r is, |f''| and |f'''| stay below 4 f', so that what such a step leaves is below 2 step^3.
    if (std::abs(step) <= 1e-5) return std::clamp(y + step, low, high);
    y = y + step >= low && y + step <= high ? y + step : 0.5 * (low + high);
    if (!(low < high)) break;
  }
  return y;
}

}  // namespace

double scaled_rate(double r, double z, double guess) {
  return std::copysign(positive_rate(r, std::abs(z), std::abs(guess)), z);
}

}  // namespace zspring
