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
  // Taken from the same code as in motion, so that the state of rest is balanced to the last bit.
  rods_ = RodsNear(static_.theta);
  if (!zspring_response(p.zspring, rods_.at(static_.theta, static_.theta), static_.gap, at_rest_))
    refuse("zspring.l0 = %g m: the spring has no length in the static state; enlarge l0 or d", p.zspring.l0);
  zspring_tangent(p.zspring, at_rest_, static_tangent);
  if (p.suspension == Suspension::LinearLocked) static_tangent = vertical_spring(static_.k_locked);
  preload.head<4>() += at_rest_.force;
}

double Mechanics::strain_energy(const Vector5& q, const ElementResponse& head) const {
  const double x = q[U2] - q[U3];
  return head.energy - at_rest_.energy + 0.5 * parameters.k2 * x * x + 0.5 * parameters.k3 * q[U3] * q[U3];
}

}  // namespace zspring
