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

#include <Eigen/Core>
#include <optional>

#include "parameters.hpp"

namespace zspring {

using Vector4 = Eigen::Matrix<double, 4, 1>;
using Matrix4 = Eigen::Matrix<double, 4, 4>;

// Response to (u1, alpha, beta, u2): energy J, force N and N m, tangent in the same units per m and rad.
struct ElementResponse {
  double energy;
  Vector4 force;
  Matrix4 tangent;
  double length, tension;  // m, N, of the spring
  Vector4 gradient;        // of its length
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

// `gap` is the absolute vertical distance u2 - u1, m. Below `shortest_length` the direction of the spring,
// and with it the force, is not defined: there is no answer.
std::optional<ElementResponse> zspring_response(const ZSpringParameters& z, double alpha, double beta, double gap);

constexpr double shortest_length = 1e-9;  // m

// The unique root of k (d/cos(theta) - L1 - L2 - l0) sin(theta) = load with the spring in tension; `load` in N
// is what hangs on the head, m1 g + F0. Throws Refusal where there is none: springs in compression or
// rods that overlap have no stable static state.
StaticState zspring_static_state(const ZSpringParameters& z, double load);

}  // namespace zspring
