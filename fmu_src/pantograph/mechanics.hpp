// The pantograph as a mechanical system: q = [u1, alpha, beta, u2, u3] = head, rod angles, upper and lower frame.
//
//   M a + C v + Fe(q) + Ff(v) = P + Fext - Fc e1
//
// M = diag(m1, J1, J2, m2, m3); dampers c1 (u1-u2), c2 (u2-u3), c3 (u3-base); springs k2, k3 and the head
// suspension; Ff the joint friction moments; P the constant preload that balances the static state under
// Fc = static_force, the origin of u1, u2, u3.
#pragma once

#include <Eigen/Core>

#include "parameters.hpp"
#include "resolvent.hpp"
#include "zspring.hpp"

namespace zspring {

using Vector2 = Eigen::Matrix<double, 2, 1>;
using Vector5 = Eigen::Matrix<double, 5, 1>;

enum Dof { U1, ALPHA, BETA, U2, U3 };

inline constexpr int mass_dof[] = {U1, U2, U3};
inline constexpr int joint_dof[] = {ALPHA, BETA};

// Those of the two joints in a vector of all degrees of freedom, and forces on the three masses as such a vector.
template <class Vector>
auto joints(Vector& x) {
  return x.template segment<2>(ALPHA);
}
inline Vector5 on_masses(const Eigen::Vector3d& f) {
  Vector5 x;
  x << f[0], 0, 0, f[1], f[2];
  return x;
}

inline constexpr const char* dof_name[] = {"head", "rod alpha", "rod beta", "upper frame", "lower frame"};

class Mechanics {
 public:
  // Throws Refusal for parameters that make no solvable model. Refers to `p`.
  explicit Mechanics(const Parameters& p);

  // Of the head's suspension, preload included; none where the spring has no direction.
  std::optional<ElementResponse> head_response(const Vector5& q) const;
  // Of all springs less the preload, with that response.
  Vector5 spring_force(const Vector5& q, const ElementResponse& head) const;
  Vector5 spring_force_change(const Matrix4& head_tangent, const Vector5& dq) const;

  Vector5 damping_force(const Vector5& v) const;
  double damping_power(const Vector5& v) const;
  double kinetic_energy(const Vector5& v) const;
  // Strain energy above that of the static state, J.
  double strain_energy(const Vector5& q, const ElementResponse& head) const;

  const Parameters& parameters;
  Calculated calculated;
  FrictionLaw law;
  Vector2 moment_bound;  // N m, scale of s = moment / bound; 1 where the law knows no bound
  Vector5 mass;
  Vector5 preload;
  Vector5 rest;            // static q: 0 but for the angles
  Matrix4 static_tangent;  // head suspension at rest
  double load;             // N, m1 gravity + static_force

 private:
  StaticState static_;  // not used with Suspension::Linear
  ElementResponse at_rest_{0, Vector4::Zero(), Matrix4::Zero(), 0, 0, Vector4::Zero()};
};

}  // namespace zspring
