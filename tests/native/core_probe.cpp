// The core's elements as C functions, for tests that compare them with differences and closed forms (ctypes).
#include "common/failure.hpp"
#include "pantograph/resolvent.hpp"
#include "pantograph/zspring.hpp"

using namespace zspring;

extern "C" {

// parameters: k, l0, L1, L2, d; coordinates: alpha, beta, gap (rad, rad, m).
// out: energy, force (4), tangent (4 x 4, row major) with respect to u1, alpha, beta, u2. Returns 0 where the
// spring has no direction.
int probe_zspring(const double parameters[5], const double coordinates[3], double out[21]) {
  const ZSpringParameters z{parameters[0], parameters[1], parameters[2], parameters[3], parameters[4], 0, 0, 0, 1};
  ElementResponse r;
  const RodDirections rods = RodsNear(coordinates[1]).at(coordinates[0], coordinates[1]);
  if (!zspring_response(z, rods, coordinates[2], r)) return 0;
  Matrix4 tangent;
  zspring_tangent(z, r, tangent);
  *out++ = r.energy;
  for (int i = 0; i < 4; ++i) *out++ = r.force[i];
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) *out++ = tangent(i, j);
  return 1;
}

// law: 0 free, 1 tanh, 2 Coulomb, 3 locked; out: w, s, dw/dz, ds/dz.
void probe_resolvent(int law, double rho, double tau, double z, double w_guess, double out[4]) {
  const decltype(&resolvent<FrictionLaw::Free>) laws[] = {resolvent<FrictionLaw::Free>, resolvent<FrictionLaw::Tanh>,
                                                          resolvent<FrictionLaw::Coulomb>,
                                                          resolvent<FrictionLaw::Locked>};
  const Resolvent r = laws[law]({rho, tau}, z, w_guess);
  out[0] = r.w;
  out[1] = r.s;
  out[2] = r.dw_dz;
  out[3] = r.ds_dz;
}

// out: theta, gap, length, tension, k_locked, k_free. Returns 0 where there is no static state.
int probe_static_state(const double parameters[5], double load, double out[6]) {
  const ZSpringParameters z{parameters[0], parameters[1], parameters[2], parameters[3], parameters[4], 0, 0, 0, 1};
  try {
    const StaticState s = zspring_static_state(z, load);
    const double values[] = {s.theta, s.gap, s.length, s.tension, s.k_locked, s.k_free};
    for (int i = 0; i < 6; ++i) out[i] = values[i];
    return 1;
  } catch (const Refusal&) {
    return 0;
  }
}

}  // extern "C"
