// Ties each variable of modelDescription.xml to the member of the core that it stands for. A variable without a
// line here does not compile, nor does a line without a variable.
#pragma once

#include "core/parameters.hpp"
#include "variables.inc"

namespace zspring::fmi {

namespace vr {
#define ZSPRING_REFERENCE(id, ...) id,
enum : unsigned { ZSPRING_VARIABLES(ZSPRING_REFERENCE) count };
#undef ZSPRING_REFERENCE
}  // namespace vr

// How to reach a variable; null for what it is not. Every type passes as double, exact for what occurs.
struct Binding {
  double (*parameter)(const Parameters&) = nullptr;
  void (*set_parameter)(Parameters&, double) = nullptr;
  double (*calculated)(const StaticStiffness&) = nullptr;
  Signal& (*input)(Inputs&) = nullptr;
  double (*output)(const Outputs&) = nullptr;
};

inline void assign(double& member, double x) { member = x; }
inline void assign(int& member, double x) { member = static_cast<int>(x); }
template <class Enum>
void assign(Enum& member, double x) {
  member = static_cast<Enum>(static_cast<int>(x));
}

template <unsigned reference>
Binding bind() = delete;  // see above

#define PARAMETER(id, member)                                                        \
  template <>                                                                        \
  constexpr Binding bind<vr::id>() {                                                 \
    Binding b;                                                                       \
    b.parameter = [](const Parameters& p) { return static_cast<double>(p.member); }; \
    b.set_parameter = [](Parameters& p, double x) { assign(p.member, x); };          \
    return b;                                                                        \
  }
#define CALCULATED(id, member)                                        \
  template <>                                                         \
  constexpr Binding bind<vr::id>() {                                  \
    Binding b;                                                        \
    b.calculated = [](const StaticStiffness& s) { return s.member; }; \
    return b;                                                         \
  }
#define INPUT(id, member)                                    \
  template <>                                                \
  constexpr Binding bind<vr::id>() {                         \
    Binding b;                                               \
    b.input = [](Inputs& u) -> Signal& { return u.member; }; \
    return b;                                                \
  }
#define OUTPUT(id, member)                                \
  template <>                                             \
  constexpr Binding bind<vr::id>() {                      \
    Binding b;                                            \
    b.output = [](const Outputs& y) { return y.member; }; \
    return b;                                             \
  }

PARAMETER(drive, drive)
PARAMETER(suspension, suspension)
PARAMETER(friction, friction)
PARAMETER(m1, m1)
PARAMETER(m2, m2)
PARAMETER(m3, m3)
PARAMETER(c1, c1)
PARAMETER(c2, c2)
PARAMETER(c3, c3)
PARAMETER(k1, k1)
PARAMETER(k2, k2)
PARAMETER(k3, k3)
PARAMETER(zspring_dot_k, zspring.k)
PARAMETER(zspring_dot_l0, zspring.l0)
PARAMETER(zspring_dot_L1, zspring.L1)
PARAMETER(zspring_dot_L2, zspring.L2)
PARAMETER(zspring_dot_d, zspring.d)
PARAMETER(zspring_dot_J1, zspring.J1)
PARAMETER(zspring_dot_J2, zspring.J2)
PARAMETER(zspring_dot_Mf, zspring.Mf)
PARAMETER(zspring_dot_tau, zspring.tau)
PARAMETER(static_force, static_force)
PARAMETER(gravity, gravity)
PARAMETER(contact_dot_k, contact_k)
PARAMETER(contact_dot_c, contact_c)
PARAMETER(bench_dot_frequency, bench_frequency)
PARAMETER(bench_dot_acceleration, bench_acceleration)
PARAMETER(solver_dot_step, solver.step)
PARAMETER(solver_dot_alpha, solver.hht_alpha)
PARAMETER(solver_dot_tangent, solver.tangent)
PARAMETER(solver_dot_tolerance, solver.tolerance)
PARAMETER(solver_dot_max_iterations, solver.max_iterations)

CALCULATED(zspring_dot_theta, theta)
CALCULATED(zspring_dot_k_locked, k_locked)
CALCULATED(zspring_dot_k_free, k_free)

INPUT(contact_force, contact_force)
INPUT(head_displacement, head_displacement)
INPUT(wire_height, wire_height)
INPUT(uplift_dot_head, uplift[0])
INPUT(uplift_dot_upper_frame, uplift[1])
INPUT(uplift_dot_lower_frame, uplift[2])

OUTPUT(head_dot_z, head_z)
OUTPUT(head_dot_v, head_v)
OUTPUT(head_dot_a, head_a)
OUTPUT(upper_frame_dot_z, upper_frame_z)
OUTPUT(upper_frame_dot_v, upper_frame_v)
OUTPUT(lower_frame_dot_z, lower_frame_z)
OUTPUT(lower_frame_dot_v, lower_frame_v)
OUTPUT(contact_dot_force, contact_force)
OUTPUT(contact_dot_closed, contact_closed)
OUTPUT(zspring_dot_alpha, alpha)
OUTPUT(zspring_dot_beta, beta)
OUTPUT(zspring_dot_length, spring_length)
OUTPUT(zspring_dot_force, spring_force)
OUTPUT(zspring_dot_moment_alpha, moment_alpha)
OUTPUT(zspring_dot_moment_beta, moment_beta)
OUTPUT(energy_dot_kinetic, kinetic)
OUTPUT(energy_dot_elastic, elastic)
OUTPUT(energy_dot_dissipated, dissipated)
OUTPUT(energy_dot_work, work)
OUTPUT(solver_dot_iterations, iterations)
OUTPUT(solver_dot_iterations_max, iterations_max)
OUTPUT(solver_dot_steps, steps)
OUTPUT(solver_dot_refinements, refinements)
OUTPUT(bench_dot_H_re, H_re)
OUTPUT(bench_dot_H_im, H_im)
OUTPUT(bench_dot_change, H_change)
OUTPUT(bench_dot_periods, periods)

#undef PARAMETER
#undef CALCULATED
#undef INPUT
#undef OUTPUT

}  // namespace zspring::fmi
