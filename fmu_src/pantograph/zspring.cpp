#include "zspring.hpp"

#include <cmath>

#include "common/failure.hpp"

namespace zspring {

StaticState zspring_static_state(const ZSpringParameters& z, double load) {
  // In t = tan(theta) >= 0 the left side grows without bound from the first t where the spring is in tension,
  // so the root is bracketed and bisection down to neighbouring numbers is exact and cannot fail.
  const auto tension = [&](double t) { return z.k * (z.d * std::sqrt(1 + t * t) - z.L1 - z.L2 - z.l0); };
  const auto missing = [&](double t) { return tension(t) * t / std::sqrt(1 + t * t) - load; };
  double low = 0, high = 1;
  constexpr double steepest = 1e6;
  while (high < steepest && !(tension(high) > 0 && missing(high) >= 0)) high *= 2;
  for (double mid = 0.5 * (low + high); low < mid && mid < high; mid = 0.5 * (low + high))
    (tension(mid) > 0 && missing(mid) >= 0 ? high : low) = mid;

  const double t = load > 0 ? high : 0;
  const double T = tension(t);
  if (!(high < steepest) || !(T > 0))
    refuse(
        "zspring.d = %g m, zspring.k = %g N/m: no static state with the spring in tension under the load "
        "m1 gravity + static_force = %g N; allowed: d above L1 + L2 + l0 = %g m or a larger load, and k "
        "stiff enough to carry it",
        z.d, z.k, load, z.L1 + z.L2 + z.l0);
  StaticState out;
  const double D = z.d * std::sqrt(1 + t * t);
  const double s2 = t * t / (1 + t * t), c2 = 1 / (1 + t * t);
  out.theta = std::atan(t);
  out.gap = z.d * t;
  out.length = D - z.L1 - z.L2;
  out.tension = T;
  out.k_locked = z.k * s2 + T / out.length * c2;
  out.k_free = z.k * s2 + T / D * c2;
  return out;
}

}  // namespace zspring
