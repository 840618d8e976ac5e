#include "zspring.hpp"

#include <cmath>

#include "common/failure.hpp"

namespace zspring {
std::optional<ElementResponse> zspring_response(const ZSpringParameters& z, double alpha, double beta, double gap) {
  const double sin_a = std::sin(alpha), cos_a = std::cos(alpha), sin_b = std::sin(beta), cos_b = std::cos(beta);
  const double A = z.L1 * cos_a + z.L2 * cos_b - z.d;
  const double B = gap - z.L1 * sin_a - z.L2 * sin_b;
  const double length = std::sqrt(A * A + B * B);
  std::optional<ElementResponse> result;
  if (!(length > shortest_length)) return result;  // also NaN
  ElementResponse& out = result.emplace();
  const double ex = A / length, ey = B / length;  // unit vector along the spring
  const double T = out.tension = z.k * (length - z.l0);
  const Vector4 n(-ey, -z.L1 * (ex * sin_a + ey * cos_a), -z.L2 * (ex * sin_b + ey * cos_b), ey);
  const Vector4 p(-ex, z.L1 * (ey * sin_a - ex * cos_a), z.L2 * (ey * sin_b - ex * cos_b), ex);
  out.gradient = n;
  out.length = length;
  out.energy = 0.5 * z.k * (length - z.l0) * (length - z.l0);
  out.force = T * n;
  out.tangent.noalias() = (z.k * n) * n.transpose();
  out.tangent.noalias() += (T / length * p) * p.transpose();
  out.tangent(1, 1) += T * z.L1 * (ey * sin_a - ex * cos_a);
  out.tangent(2, 2) += T * z.L2 * (ey * sin_b - ex * cos_b);
  return result;
}

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
