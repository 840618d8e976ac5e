// One step of HHT-alpha (Hilber, Hughes, Taylor 1977) with Newton's method on the resolvent of the friction law.
//
//   M a[n+1] + (1 + hht_alpha) R[n+1] - hht_alpha R[n] = 0,   R = C v + Fe + Ff - P - Fext + Fc e1
//   q[n+1] = q + h v + h^2 ((1/2 - beta) a + beta a[n+1]),   v[n+1] = v + h ((1 - gamma) a + gamma a[n+1])
//   beta = (1 - hht_alpha)^2 / 4,   gamma = 1/2 - hht_alpha
//
// The unknowns are the accelerations of u1, u2, u3 and, per joint, z = rho w + s (friction.hpp). With the other
// tangents, which need a law with a slope, the joint's unknown is its acceleration.
//
// A step is done when every unbalanced force is within `tolerance` of the load on it, or when the last change of q
// was within tolerance (1 + |q|). The resolvent form converges quadratically and is then exact to rounding. Mean
// and Secant converge linearly: their small change is not yet a small error, which is one reason against them.
#pragma once

#include "state.hpp"

namespace zspring {

struct HhtCoefficients {
  HhtCoefficients(const Mechanics& m, double step);

  double h;                           // s
  double beta_h2, gamma_h;            // s2, s
  double old_position, old_velocity;  // (1/2 - beta) h^2, (1 - gamma) h
  double alpha, weight;               // hht_alpha, 1 + hht_alpha
  Vector2 rho;                        // s/rad
};

// One iterate: the unknowns and what follows from them.
struct Trial {
  Vector5 x;  // unknowns
  Vector5 q, v, a;
  Vector2 s;
  Vector5 internal;
  double contact_force;  // Drive::Force and Wire
  Matrix4 head_tangent;
  Vector2 angle_slope, acceleration_slope, moment_slope;  // d(q, a, s)/dx of the joints
  bool closed;                                            // Drive::Wire
};

struct StepFailure {
  double residual = 0;  // N or N m
  int dof = 0;
  int iterations = 0;
};

class Hht {
 public:
  explicit Hht(const Mechanics& mechanics) : m_(mechanics) {}

  // Moves HHT's acceleration to where a step of h s expects it; linear, so that it serves variations as well.
  void prepare(double h, double h_last, MechanicalState& s) const;

  // From `from`, prepared, under the boundary `b0` to `to` under `b1`; `to` keeps from's statistics plus this
  // attempt's. False, with `failure` filled and `to` without meaning, when Newton does not converge.
  bool step(const MechanicalState& from, const Boundary& b0, const Boundary& b1, double h, MechanicalState& to,
            StepFailure& failure) const;

  // The parts that the linearised step shares. `direct`: the unknown of a joint is its acceleration, not z.
  bool head_imposed() const {
    return m_.parameters.drive == Drive::Displacement || m_.parameters.drive == Drive::Bench;
  }
  double head_force(const Boundary& b, double u, double v, bool& closed) const;  // N, Force and Wire
  // N, of an imposed motion, from the balance at this instant itself, where the acceleration is known to second
  // order; HHT's weighted balance would give the force of an earlier instant. Linear.
  double reaction(const Boundary& b, const Vector5& internal) const;
  // What does work on the pantograph at one instant, N, without the preload and so linear.
  Vector5 push(const Boundary& b, double contact_force) const;
  bool evaluate(const HhtCoefficients& c, const MechanicalState& from, const Boundary& b1, bool direct,
                Trial& t) const;
  bool solve(const HhtCoefficients& c, const Trial& t, Vector5& residual) const;  // residual -> J^-1 residual
  const Mechanics& mechanics() const { return m_; }

 private:
  Vector5 old_load(const MechanicalState& from, const Boundary& b0) const;
  Vector5 residual_scale(const MechanicalState& from) const;
  void accept(const HhtCoefficients& c, const MechanicalState& from, const Boundary& b0, const Boundary& b1,
              const Trial& t, MechanicalState& to) const;

  const Mechanics& m_;
};

}  // namespace zspring
