// The pantograph as the FMI layer sees it: each variable of its model description, but the outputs, and what it
// stands for.
#pragma once

#include "pantograph/simulation.hpp"

namespace zspring::fmi {
using Calculated = StaticStiffness;
}  // namespace zspring::fmi

#include "binding.hpp"

namespace zspring::fmi {

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

}  // namespace zspring::fmi
