// What a user can set: parameters and inputs of the pantograph; its outputs are in outputs.cpp.
//
// SI units throughout. Vertical quantities are upward positive and measured from the static state under
// `static_force`; angles in rad. There are no default values here: the model description holds them.
#pragma once

#include "common/signal.hpp"

namespace zspring {

enum class Drive { Force = 1, Displacement, Wire, Bench };
enum class Suspension { ZSpring = 1, Linear, LinearLocked, LinearFree };
enum class Friction { Regularized = 1, Coulomb, Locked, Free };
enum class Tangent { Resolvent = 1, Mean, Secant, Exact };

// Two rigid rods and one spring; k, J1, J2 and Mf are the totals of the four real oblique springs.
struct ZSpringParameters {
  double k;       // N/m, > 0
  double l0;      // m, natural length, >= 0
  double L1, L2;  // m, rod lengths, > 0
  double d;       // m, horizontal distance of the two joints, > 0
  double J1, J2;  // kg m2, rod inertia about its joint, >= 0
  double Mf;      // N m, friction moment bound of each joint, >= 0
  double tau;     // s, regularisation Mf tanh(tau w), > 0
};

struct ContactParameters {
  double k, c;  // N/m, N s/m
};

struct BenchParameters {
  double frequency = 0;     // Hz, > 0
  double acceleration = 0;  // m/s2, peak
};
ZSPRING_MEMBERS(BenchParameters, frequency, acceleration)

struct SolverParameters {
  double step;       // s, largest internal step
  double hht_alpha;  // [-1/3, 0]
  Tangent tangent;
  double tolerance;  // of Newton's method, see hht.hpp
  int max_iterations;
};

// Named and nested as the variables of the model description are, and in their order: so they find each other.
struct Parameters {
  Drive drive;
  Suspension suspension;
  Friction friction;
  double m1, m2, m3;  // kg; head, upper frame, lower frame; m3 may be 0
  double c1, c2, c3;  // N s/m
  double k1, k2, k3;  // N/m; k1 for Suspension::Linear only
  ZSpringParameters zspring;
  double static_force;        // N
  double gravity;             // m/s2
  ContactParameters contact;  // Drive::Wire
  BenchParameters bench;      // Drive::Bench; may change between steps
  SolverParameters solver;
};

struct Uplift {
  Signal head, upper_frame, lower_frame;  // N
};
ZSPRING_MEMBERS(Uplift, head, upper_frame, lower_frame)

// How the wire gives way to the contact force at the end of a communication step and at its begin; values alone count.
struct Wire {
  Signal compliance, compliance_previous;  // m/N, >= 0

  bool gives_way() const { return compliance.value != 0 || compliance_previous.value != 0; }
};
ZSPRING_MEMBERS(Wire, compliance, compliance_previous)

struct Inputs {
  Signal contact_force;      // N, Drive::Force
  Signal head_displacement;  // m, Drive::Displacement
  Signal wire_height;        // m, Drive::Wire; of a wire that gives way its height without force
  Uplift uplift;
  Wire wire;  // Drive::Wire
};
ZSPRING_MEMBERS(Inputs, contact_force, head_displacement, wire_height, uplift, wire)

// The calculated parameters; all 0 with Suspension::Linear.
struct Calculated {
  struct {
    double theta = 0;     // rad
    double k_locked = 0;  // N/m
    double k_free = 0;    // N/m
  } zspring;
};

}  // namespace zspring
