#include "zspring.hpp"

#include <cmath>

#include "common/failure.hpp"

namespace zspring {
namespace {

struct Shape {
  double sin_a, cos_a, sin_b, cos_b;
  double length;
  double ex, ey;  // unit vector along the spring
};

inline std::optional<Shape> shape(const ZSpringParameters& z, double alpha, double beta, double gap) {
  Shape s;
  s.sin_a = std::sin(alpha);
  s.cos_a = std::cos(alpha);
  s.sin_b = std::sin(beta);
  s.cos_b = std::cos(beta);
  const double A = z.L1 * s.cos_a + z.L2 * s.cos_b - z.d;
  const double B = gap - z.L1 * s.sin_a - z.L2 * s.sin_b;
  s.length = std::sqrt(A * A + B * B);
  if (!(s.length > shortest_length)) return std::nullopt;  // also NaN
  s.ex = A / s.length;
  s.ey = B / s.length;
  return s;
}

inline Vector4 length_gradient(const ZSpringParameters& z, const Shape& s) {
  return {-s.ey, -z.L1 * (s.ex * s.sin_a + s.ey * s.cos_a), -z.L2 * (s.ex * s.sin_b + s.ey * s.cos_b), s.ey};
}

}  // namespace

std::optional<ElementResponse> zspring_response(const ZSpringParameters& z, double alpha, double beta, double gap) {
  std::optional<ElementResponse> result;
  const std::optional<Shape> known = shape(z, alpha, beta, gap);
  if (!known) return result;
  const Shape& s = *known;
  ElementResponse& out = result.emplace();
  const double T = out.tension = z.k * (s.length - z.l0);
  const Vector4& n = out.gradient = length_gradient(z, s);
  const Vector4 p(-s.ex, z.L1 * (s.ey * s.sin_a - s.ex * s.cos_a), z.L2 * (s.ey * s.sin_b - s.ex * s.cos_b), s.ex);
  out.length = s.length;
  out.energy = 0.5 * z.k * (s.length - z.l0) * (s.length - z.l0);
  out.force = T * n;
  out.tangent.noalias() = (z.k * n) * n.transpose();
  out.tangent.noalias() += (T / s.length * p) * p.transpose();
  out.tangent(1, 1) += T * z.L1 * (s.ey * s.sin_a - s.ex * s.cos_a);
  out.tangent(2, 2) += T * z.L2 * (s.ey * s.sin_b - s.ex * s.cos_b);
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
