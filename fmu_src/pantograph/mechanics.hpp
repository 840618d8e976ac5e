// The pantograph as a mechanical system: q = [u1, alpha, beta, u2, u3] = head, rod angles, upper and lower frame.
//
//   M a + C v + Fe(q) + Ff(v) = P + Fext - Fc e1
//
// M = diag(m1, J1, J2, m2, m3); dampers c1 (u1-u2), c2 (u2-u3), c3 (u3-base); springs k2, k3 and the head
// suspension; Ff the joint friction moments; P the constant preload that balances the static state under
// Fc = static_force, the origin of u1, u2, u3.
#pragma once

#include "parameters.hpp"
#include "resolvent.hpp"
#include "zspring.hpp"

namespace zspring {

enum Dof { U1, ALPHA, BETA, U2, U3 };

inline constexpr int mass_dof[] = {U1, U2, U3};
inline constexpr int joint_dof[] = {ALPHA, BETA};

// Those of the two joints in a vector of all degrees of freedom, and forces on the three masses as such a vector.
template <class Vector>
auto joints(Vector& x) {
  return x.template segment<2>(ALPHA);
}
inline Vector5 on_masses(const Eigen::Vector3d& f) {
  Vector5 x = Vector5::Zero();
  for (int k = 0; k < 3; ++k) x[mass_dof[k]] = f[k];
  return x;
}

inline constexpr const char* dof_name[] = {"head", "rod alpha", "rod beta", "upper frame", "lower frame"};

class Mechanics {
 public:
  // Throws Refusal for parameters that make no solvable model. Refers to `p`.
  explicit Mechanics(const Parameters& p);

  // Of the head's suspension, preload included; false where the spring has no direction.
  [[nodiscard]] bool head_response(const Vector5& q, ElementResponse& out) const;
  void head_tangent(const ElementResponse& head, Matrix4& out) const;
  // Of all springs less the preload, with that response.
  Vector5 spring_force(const Vector5& q, const ElementResponse& head) const;
  Vector5 spring_force_change(const Matrix4& head_tangent, const Vector5& dq) const;

  Vector5 damping_force(const Vector5& v) const;
  double damping_power(const Vector5& v) const;
  double kinetic_energy(const Vector5& v) const { return 0.5 * v.dot(mass.cwiseProduct(v)); }
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
  RodsNear rods_;       // near the static state
  ElementResponse at_rest_;
};

// In every iteration of every step, and so to be seen by the compiler there.

inline bool Mechanics::head_response(const Vector5& q, ElementResponse& out) const {
  if (parameters.suspension == Suspension::ZSpring)
    return zspring_response(parameters.zspring, rods_.at(q[ALPHA], q[BETA]), static_.gap + q[U2] - q[U1], out);
  const Vector4 x = q.head<4>() - rest.head<4>();
  out = at_rest_;
  out.force.noalias() += static_tangent * x;
  out.energy = at_rest_.energy + 0.5 * x.dot(at_rest_.force + out.force);
  const double stretch = out.gradient.dot(x);
  out.length += stretch;
  out.tension += parameters.zspring.k * stretch;
  return true;
}

inline void Mechanics::head_tangent(const ElementResponse& head, Matrix4& out) const {
  if (parameters.suspension == Suspension::ZSpring)
    zspring_tangent(parameters.zspring, head, out);
  else
    out = static_tangent;
}

inline Vector5 Mechanics::spring_force(const Vector5& q, const ElementResponse& head) const {
  const double f2 = parameters.k2 * (q[U2] - q[U3]);
  Vector5 f;
  for (int i = 0; i < 4; ++i) f[i] = head.force[i] - at_rest_.force[i];
  f[U1] -= parameters.static_force;
  f[U2] += f2;
  f[U3] = parameters.k3 * q[U3] - f2;
  return f;
}

inline Vector5 Mechanics::spring_force_change(const Matrix4& head_tangent, const Vector5& dq) const {
  const double f2 = parameters.k2 * (dq[U2] - dq[U3]);
  Vector5 f;
  f.head<4>().noalias() = head_tangent * dq.head<4>();
  f[U2] += f2;
  f[U3] = parameters.k3 * dq[U3] - f2;
  return f;
}

inline Vector5 Mechanics::damping_force(const Vector5& v) const {
  const double f1 = parameters.c1 * (v[U1] - v[U2]);
  const double f2 = parameters.c2 * (v[U2] - v[U3]);
  Vector5 f;
  f << f1, 0, 0, f2 - f1, parameters.c3 * v[U3] - f2;
  return f;
}

inline double Mechanics::damping_power(const Vector5& v) const {
  const double v1 = v[U1] - v[U2], v2 = v[U2] - v[U3], v3 = v[U3];
  return parameters.c1 * v1 * v1 + parameters.c2 * v2 * v2 + parameters.c3 * v3 * v3;
}

}  // namespace zspring
