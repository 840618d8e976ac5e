#include "resolvent.hpp"

#include <algorithm>
#include <cmath>

namespace zspring {
namespace {

// tanh for y >= 0; absolute error of a few 1e-16, faster than std::tanh.
inline double tanh_positive(double y) { return 1 - 2 / (1 + std::exp(2 * y)); }

// The root y >= 0 of r y + tanh(y) = z, z >= 0, by Halley's method (third order) inside a bracket that holds it:
// tanh(y) <= 1 and tanh(y) <= y from below, tanh(y) >= 0 from above.
double scaled_rate(double r, double z, double guess) {
  const double slipping = (z - 1) / r;
  if (slipping > 20) return slipping;  // tanh is 1 to the last bit
  double low = std::max(z / (1 + r), slipping);
  double high = z / r;
  double y = guess > low && guess < high ? guess : low;
  for (int i = 0; i < 100; ++i) {
    const double t = tanh_positive(y);
    const double f = r * y + t - z;
    const double slope = (1 - t) * (1 + t);
    const double df = r + slope;
    (f < 0 ? low : high) = y;
    const double step = -f * df / (df * df + f * t * slope);
    // Whatever r is, |f''| and |f'''| stay below 4 f', so that what such a step leaves is below 2 step^3.
    if (std::abs(step) <= 1e-5) return std::clamp(y + step, low, high);
    y = y + step >= low && y + step <= high ? y + step : 0.5 * (low + high);
    if (!(low < high)) break;
  }
  return y;
}

}  // namespace

Resolvent resolvent(FrictionLaw law, double rho, double tau, double z, double w_guess) {
  switch (law) {
    case FrictionLaw::Locked:
      return {0, z, 0, 1};
    case FrictionLaw::Coulomb: {
      const double s = std::clamp(z, -1.0, 1.0);
      const bool sticks = z == s;
      return {(z - s) / rho, s, sticks ? 0 : 1 / rho, sticks ? 1.0 : 0.0};
    }
    case FrictionLaw::Tanh: {
      const double y = scaled_rate(rho / tau, std::abs(z), std::abs(tau * w_guess));
      const double w = std::copysign(y / tau, z);
      const double s = z - rho * w;
      const double t = tanh_positive(y);
      const double g = tau * (1 - t) * (1 + t);
      return {w, s, 1 / (rho + g), g / (rho + g)};
    }
    case FrictionLaw::Free:
      break;
  }
  return {z / rho, 0, 1 / rho, 0};
}

}  // namespace zspring
