// Dry friction in a rod joint, as a maximal monotone graph s in law(w): w rad/s, s = moment / bound in [-1, 1].
//
// Newton's method does not see the steep law itself but its resolvent: with the unknown z = rho w + s both
// w(z) and s(z) are single-valued with slopes dw/dz = 1/(rho + g) and ds/dz = g/(rho + g), g = law'(w), which
// are bounded however steep the law is. One code path so serves every law, the set-valued one included.
#pragma once

namespace zspring {

enum class FrictionLaw {
  Free,     // s = 0
  Tanh,     // s = tanh(tau w): creeps at atanh(s)/tau under any moment, cannot stick
  Coulomb,  // s = Sgn(w): sticks truly, w = 0 exactly for |s| < 1
  Locked,   // w = 0, s is the moment that holds the rod, without bound
};

struct Resolvent {
  double w, s;          // rad/s, 1
  double dw_dz, ds_dz;  // s/rad of z's unit; 1
};

// The root y of r y + tanh(y) = z; `guess` only saves iterations.
double scaled_rate(double r, double z, double guess);

// Of one joint in steps of one length.
struct JointScale {
  JointScale() = default;
  // `rho` > 0 in s/rad; `tau` in s, for Tanh only.
  JointScale(double rho_of_step, double tau_of_law)
      : rho(rho_of_step), inverse(1 / rho), ratio(rho / tau_of_law), tau(tau_of_law), inverse_tau(1 / tau_of_law) {}

  double rho, inverse, ratio, tau, inverse_tau;
};

// `w_guess` for Tanh only.
template <FrictionLaw law>
inline Resolvent resolvent(const JointScale& c, double z, double w_guess) {
  if constexpr (law == FrictionLaw::Locked) return {0, z, 0, 1};
  if constexpr (law == FrictionLaw::Coulomb) {
    const double s = z < -1 ? -1 : z > 1 ? 1 : z;
    const bool sticks = z == s;
    return {(z - s) * c.inverse, s, sticks ? 0 : c.inverse, sticks ? 1.0 : 0.0};
  }
  if constexpr (law == FrictionLaw::Tanh) {
    const double w = scaled_rate(c.ratio, z, c.tau * w_guess) * c.inverse_tau, s = z - c.rho * w;
    const double g = s * s < 1 ? c.tau * (1 - s) * (1 + s) : 0, slope = 1 / (c.rho + g);
    return {w, s, slope, g * slope};
  }
  return {z * c.inverse, 0, c.inverse, 0};
}

}  // namespace zspring
