// One step of HHT-alpha (common/hht.hpp) with Newton's method on the resolvent of the friction law.
//
//   M a[n+1] + (1 + hht_alpha) R[n+1] - hht_alpha R[n] = 0,   R = C v + Fe + Ff - P - Fext + Fc e1
//
// The unknowns are the accelerations of u1, u2, u3 and, per joint, z = rho w + s (resolvent.hpp). With the other
// tangents, which need a law with a slope, the joint's unknown is its acceleration.
//
// A step is done when every unbalanced force is within `tolerance` of the load on it, or when the last change of q
// was within tolerance (1 + |q|). The resolvent form converges quadratically and is then exact to rounding. Mean
// and Secant converge linearly: their small change is not yet a small error, which is one reason against them.
#pragma once

#include <optional>

#include "common/hht.hpp"
#include "state.hpp"

namespace zspring {

// Of one length of step.
struct StepCoefficients : HhtCoefficients {
  StepCoefficients(const Mechanics& m, double step);

  JointScale joint[2];
  double inverse_h, inverse_gamma_h;  // 1/s
  // Of the lower frame, which Newton's matrix couples to the upper one alone, kg: the coupling, the diagonal's inverse
  // and their product.
  double coupling, lower_inverse, lower_share;
};

struct Contact {
  double force;  // N
  bool closed;
};

// One iterate: the unknowns and what follows from them.
struct Trial {
  Vector5 q0, v0;  // predictors: with the acceleration 0 at the end of the step
  Vector5 x;       // unknowns
  Vector5 q, v, a;
  Vector2 s;
  Vector5 internal;
  Contact contact;  // Drive::Force and Wire
  ElementResponse head;
  Vector2 angle_slope, acceleration_slope, moment_slope;  // d(q, a, s)/dx of the joints
};

// How Newton's method ended.
struct Convergence {
  bool reached = false;
  int iterations = 0;
  int dof = 0;          // the worst one
  double residual = 0;  // N or N m, there
};

class Hht {
 public:
  explicit Hht(const Mechanics& mechanics);

  // From `from`, its memory moved to steps of h s, to `to` under the boundary `b1`. Where Newton does not converge
  // `to` is without meaning; its statistics never have one.
  Convergence step(const MechanicalState& from, const Boundary& b1, double h, MechanicalState& to) const {
    if (!coefficients_ || coefficients_->h != h) coefficients_.emplace(m_, h);
    return (this->*variant_->step)(*coefficients_, from, b1, to);
  }

  // step_variation.cpp. How the result `to` of the step from `from` varies with that and with the surroundings;
  // variations are held in the same structures as what varies. The memory of `from` and `dfrom` is moved to steps of
  // to.h s. By the implicit function theorem on the converged step, so exact where the friction law has a slope and
  // one-sided at the points where stick turns into slip.
  MechanicalState step_variation(const MechanicalState& from, const MechanicalState& to, const MechanicalState& dfrom,
                                 const Boundary& db1) const;

  bool head_imposed() const {
    return m_.parameters.drive == Drive::Displacement || m_.parameters.drive == Drive::Bench;
  }
  Contact contact(const Boundary& b, double u, double v) const;  // Force and Wire
  // N, of an imposed motion, from the balance at this instant itself, where the acceleration is known to second
  // order; HHT's weighted balance would give the force of an earlier instant. Linear.
  double reaction(const Boundary& b, const Vector5& internal) const;
  // The true accelerations at this instant, from the balance of forces; HHT's where a mass is 0, m/s2 and rad/s2. The
  // head's is linear.
  Vector5 acceleration(const MechanicalState& s) const;
  double head_acceleration(const MechanicalState& s) const;
  // What does work on the pantograph at one instant, N, without the preload and so linear.
  Vector5 push(const Boundary& b, double contact_force) const;
  const Mechanics& mechanics() const { return m_; }

 private:
  // The functions below, compiled for one drive and one law each.
  struct Variant {
    Convergence (Hht::*step)(const StepCoefficients&, const MechanicalState&, const Boundary&, MechanicalState&) const;
    bool (Hht::*evaluate)(const StepCoefficients&, const Boundary&, Trial&) const;
    bool (Hht::*solve)(const StepCoefficients&, const Trial&, Vector5&) const;
  };
  template <bool imposed>
  static const Variant& variant_of(const Mechanics& m);

  // `direct`: the unknown of a joint is its acceleration, not z.
  template <bool imposed, FrictionLaw law, bool direct>
  Convergence solve_step(const StepCoefficients& c, const MechanicalState& from, const Boundary& b1,
                         MechanicalState& to) const;
  void predict(const StepCoefficients& c, const MechanicalState& from, Trial& t) const;
  // From t.x all the rest of t; false where the spring has no direction.
  template <bool imposed, FrictionLaw law, bool direct>
  bool evaluate(const StepCoefficients& c, const Boundary& b1, Trial& t) const;
  // residual -> J^-1 residual; false where J is not positive definite
  template <bool imposed>
  bool solve(const StepCoefficients& c, const Trial& t, Vector5& residual) const;
  double force_scale(const MechanicalState& from) const;
  void accept(const StepCoefficients& c, const MechanicalState& from, const Boundary& b1, const Trial& t,
              MechanicalState& to) const;

  const Mechanics& m_;
  const Variant* variant_;
  mutable std::optional<StepCoefficients> coefficients_;  // of the last step
};

}  // namespace zspring
