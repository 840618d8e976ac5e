// The Z-spring: two rigid rods joined by one spring, between the head (u1) and the upper frame (u2).
//
// Lumped-mass model of the DSA-380 pantograph ("non-linear modelling of the DSA-380 pantograph"), derived here
// from the energy and not from the printed internal forces, whose rows are swapped:
//
//   A = L1 cos(alpha) + L2 cos(beta) - d            horizontal gap that the spring closes
//   B = -L1 sin(alpha) - L2 sin(beta) + gap         vertical, gap = u2 - u1 (absolute)
//   l = sqrt(A^2 + B^2),  T = k (l - l0),  E = 1/2 k (l - l0)^2
//
// With e = (A, B)/l, n = grad l and p = (-B dA + A dB)/l the derivatives are
//
//   force   dE/dq   = T n
//   tangent d2E/dq2 = k n n' + T/l p p' + T diag(e . d2(A, B))
#pragma once

#include <algorithm>
#include <cmath>

#include "parameters.hpp"
#include "vectors.hpp"

namespace zspring {

// Response to (u1, alpha, beta, u2): energy J, force N and N m.
struct ElementResponse {
  double energy = 0;
  Vector4 force = Vector4::Zero();
  double length = 0, tension = 0;      // m, N, of the spring
  double ratio = 0;                    // N/m, tension by length
  Vector4 gradient = Vector4::Zero();  // n, of its length
  Vector4 turning = Vector4::Zero();   // p, by which it turns, times the length
};

// Rods and spring collinear at `theta` under the load that the head carries, T > 0.
struct StaticState {
  double theta;     // rad
  double gap;       // m, u2 - u1 = d tan(theta)
  double length;    // m
  double tension;   // N
  double k_locked;  // N/m, vertical stiffness with rods held: k s^2 + (T/l) c^2
  double k_free;    // N/m, vertical stiffness with free rods: k s^2 + (T/D) c^2, D = d/cos(theta)
};

constexpr double shortest_length = 1e-9;  // m

// Sines and cosines of the rods' angles alpha and beta.
struct RodDirections {
  double sin_a, cos_a, sin_b, cos_b;
};

// Of any angles, faster near one of both rods: there by the addition theorem and Taylor's series, exact to rounding.
class RodsNear {
 public:
  explicit RodsNear(double angle = 0) : angle_(angle), sine_(std::sin(angle)), cosine_(std::cos(angle)) {}

  RodDirections at(double alpha, double beta) const {
    constexpr double range = 0.5;  // rad: the first term left out is below 1e-18
    const Eigen::Array2d x(alpha - angle_, beta - angle_);
    if (!(std::max(std::abs(x[0]), std::abs(x[1])) <= range))
      return {std::sin(alpha), std::cos(alpha), std::sin(beta), std::cos(beta)};
    const Eigen::Array2d x2 = x * x, x4 = x2 * x2, x8 = x4 * x4;
    const auto series = [&](const double (&c)[8]) -> Eigen::Array2d {
      return ((c[0] + c[1] * x2) + (c[2] + c[3] * x2) * x4) + ((c[4] + c[5] * x2) + (c[6] + c[7] * x2) * x4) * x8;
    };
    static constexpr double of_sine[] = {1,           -1. / 6,        1. / 120,         -1. / 5040,
                                         1. / 362880, -1. / 39916800, 1. / 6227020800., -1. / 1307674368000.};
    static constexpr double of_cosine[] = {1,          -1. / 2,       1. / 24,         -1. / 720,
                                           1. / 40320, -1. / 3628800, 1. / 479001600., -1. / 87178291200.};
    const Eigen::Array2d s = x * series(of_sine), c = series(of_cosine);
    const Eigen::Array2d sine = sine_ * c + cosine_ * s, cosine = cosine_ * c - sine_ * s;
    return {sine[0], cosine[0], sine[1], cosine[1]};
  }

 private:
  double angle_, sine_, cosine_;
};

// `gap` is the absolute vertical distance u2 - u1, m. Below `shortest_length` the direction of the spring,
// and with it the force, is not defined: false, and nothing in `out`.
[[nodiscard]] inline bool zspring_response(const ZSpringParameters& z, const RodDirections& rods, double gap,
                                           ElementResponse& out) {
  const auto [sin_a, cos_a, sin_b, cos_b] = rods;
  const double A = z.L1 * cos_a + z.L2 * cos_b - z.d;
  const double B = gap - z.L1 * sin_a - z.L2 * sin_b;
  const double length = std::sqrt(A * A + B * B);
  if (!(length > shortest_length)) return false;                          // also NaN
  const double inverse = 1 / length, ex = A * inverse, ey = B * inverse;  // e: unit vector along the spring
  const double stretch = length - z.l0, T = z.k * stretch;
  out.gradient << -ey, -z.L1 * (ex * sin_a + ey * cos_a), -z.L2 * (ex * sin_b + ey * cos_b), ey;
  out.turning << -ex, z.L1 * (ey * sin_a - ex * cos_a), z.L2 * (ey * sin_b - ex * cos_b), ex;
  out.energy = 0.5 * T * stretch;
  out.force = T * out.gradient;
  out.length = length;
  out.tension = T;
  out.ratio = T * inverse;
  return true;
}

// Its derivative, in the units of the force per m and rad.
inline void zspring_tangent(const ZSpringParameters& z, const ElementResponse& r, Matrix4& out) {
  const Vector4 &n = r.gradient, &p = r.turning;
  for (int j = 0; j < 4; ++j) out.col(j) = (z.k * n[j]) * n + (r.ratio * p[j]) * p;
  for (int j = 1; j < 3; ++j) out(j, j) += r.tension * p[j];
}

// The unique root of k (d/cos(theta) - L1 - L2 - l0) sin(theta) = load with the spring in tension; `load` in N
// is what hangs on the head, m1 g + F0. Throws Refusal where there is none: springs in compression or
// rods that overlap have no stable static state.
StaticState zspring_static_state(const ZSpringParameters& z, double load);

}  // namespace zspring
