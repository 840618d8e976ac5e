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

// `rho` > 0 in s/rad; `tau` in s, > 0, for Tanh only; `w_guess` only saves iterations of the scalar solve.
Resolvent resolvent(FrictionLaw law, double rho, double tau, double z, double w_guess);

}  // namespace zspring
