#include "mechanics.hpp"

#include "common/failure.hpp"

namespace zspring {
namespace {

// One linear spring k between u1 and u2; the rods carry nothing.
Matrix4 vertical_spring(double k) {
  Matrix4 K = Matrix4::Zero();
  K(0, 0) = K(3, 3) = k;
  K(0, 3) = K(3, 0) = -k;
  return K;
}

FrictionLaw friction_law(const Parameters& p) {
  if (p.suspension == Suspension::LinearFree) return FrictionLaw::Free;
  if (p.suspension != Suspension::ZSpring) return FrictionLaw::Locked;
  if (p.friction == Friction::Locked) return FrictionLaw::Locked;
  if (p.friction == Friction::Free || p.zspring.Mf == 0) return FrictionLaw::Free;
  return p.friction == Friction::Coulomb ? FrictionLaw::Coulomb : FrictionLaw::Tanh;
}

}  // namespace

Mechanics::Mechanics(const Parameters& p) : parameters(p), law(friction_law(p)) {
  const bool bounded = law == FrictionLaw::Tanh || law == FrictionLaw::Coulomb;
  if (law == FrictionLaw::Coulomb && p.solver.tangent != Tangent::Resolvent)
    refuse("solver.tangent: with friction Coulomb only Resolvent is allowed, the law has no slope");
  if (!(p.m3 + p.c2 + p.c3 + p.k2 + p.k3 > 0))
    refuse("m3 = 0 kg: must be more than 0 where c2, c3, k2 and k3 are all 0, nothing holds the lower frame");

  moment_bound.setConstant(bounded ? p.zspring.Mf : 1);
  mass << p.m1, p.zspring.J1, p.zspring.J2, p.m2, p.m3;
  load = p.m1 * p.gravity + p.static_force;
  rest.setZero();
  preload.setZero();
  preload[U1] = p.static_force;

  if (p.suspension == Suspension::Linear) {
    static_tangent = vertical_spring(p.k1);
    return;
  }
  static_ = zspring_static_state(p.zspring, load);
  calculated.zspring = {static_.theta, static_.k_locked, static_.k_free};
  rest[ALPHA] = rest[BETA] = static_.theta;
  const auto at_rest = zspring_response(p.zspring, static_.theta, static_.theta, static_.gap);
  if (!at_rest)
    refuse("zspring.l0 = %g m: the spring has no length in the static state; enlarge l0 or d", p.zspring.l0);
  // Taken from the same code as in motion, so that the state of rest is balanced to the last bit.
  at_rest_ = *at_rest;
  static_tangent = p.suspension == Suspension::LinearLocked ? vertical_spring(static_.k_locked) : at_rest_.tangent;
  preload.head<4>() += at_rest_.force;
}

std::optional<ElementResponse> Mechanics::head_response(const Vector5& q) const {
  if (parameters.suspension == Suspension::ZSpring)
    return zspring_response(parameters.zspring, q[ALPHA], q[BETA], static_.gap + q[U2] - q[U1]);
  const Vector4 x = q.head<4>() - rest.head<4>();
  ElementResponse out = at_rest_;
  out.tangent = static_tangent;
  out.force.noalias() += static_tangent * x;
  out.energy = at_rest_.energy + 0.5 * x.dot(at_rest_.force + out.force);
  const double stretch = out.gradient.dot(x);
  out.length += stretch;
  out.tension += parameters.zspring.k * stretch;
  return out;
}

Vector5 Mechanics::spring_force(const Vector5& q, const ElementResponse& head) const {
  const double f2 = parameters.k2 * (q[U2] - q[U3]);
  Vector5 f;
  f.head<4>() = head.force - at_rest_.force;
  f[U1] -= parameters.static_force;
  f[U2] += f2;
  f[U3] = parameters.k3 * q[U3] - f2;
  return f;
}

Vector5 Mechanics::spring_force_change(const Matrix4& head_tangent, const Vector5& dq) const {
  const double f2 = parameters.k2 * (dq[U2] - dq[U3]);
  Vector5 f;
  f.head<4>().noalias() = head_tangent * dq.head<4>();
  f[U2] += f2;
  f[U3] = parameters.k3 * dq[U3] - f2;
  return f;
}

Vector5 Mechanics::damping_force(const Vector5& v) const {
  const double f1 = parameters.c1 * (v[U1] - v[U2]);
  const double f2 = parameters.c2 * (v[U2] - v[U3]);
  Vector5 f;
  f << f1, 0, 0, f2 - f1, parameters.c3 * v[U3] - f2;
  return f;
}

double Mechanics::damping_power(const Vector5& v) const {
  const double v1 = v[U1] - v[U2], v2 = v[U2] - v[U3], v3 = v[U3];
  return parameters.c1 * v1 * v1 + parameters.c2 * v2 * v2 + parameters.c3 * v3 * v3;
}

double Mechanics::kinetic_energy(const Vector5& v) const { return 0.5 * v.dot(mass.cwiseProduct(v)); }

double Mechanics::strain_energy(const Vector5& q, const ElementResponse& head) const {
  const double x = q[U2] - q[U3];
  return head.energy - at_rest_.energy + 0.5 * parameters.k2 * x * x + 0.5 * parameters.k3 * q[U3] * q[U3];
}

}  // namespace zspring
