#include "communication_step.hpp"

#include <cmath>

namespace zspring {

Discard unsolved(double time, const Convergence& end) {
  if (!std::isfinite(end.residual))
    return {time,
            text("no solution even after halving the internal step to 1/1024: the spring would have no length, or the "
                 "values overflow")};
  return {time,
          text("no solution even after halving the internal step to 1/1024; %s: unbalanced by %.3g %s, iterations: %d",
               dof_name[end.dof], end.residual, end.dof == ALPHA || end.dof == BETA ? "N.m" : "N", end.iterations)};
}

// A force takes HHT's memory of the acceleration with it; else the first step would still feel the old force, an
// error of first order. An imposed velocity costs the work of an impulse.
void meet(const Hht& hht, const Boundary& b0, MechanicalState& s) {
  if (hht.head_imposed()) s.work += 0.5 * hht.mechanics().mass[U1] * (b0.velocity * b0.velocity - s.v[U1] * s.v[U1]);
  meet_variation(hht, b0, s);
}

void meet_variation(const Hht& hht, const Boundary& b0, MechanicalState& s) {
  const Vector5& mass = hht.mechanics().mass;
  for (int k = 0; k < 3; ++k)
    if (mass[mass_dof[k]] > 0) s.a[mass_dof[k]] += (b0.uplift[k] - s.boundary.uplift[k]) / mass[mass_dof[k]];
  if (hht.mechanics().parameters.drive == Drive::Force) {
    s.a[U1] -= (b0.contact_force - s.contact_force) / mass[U1];
    s.contact_force = b0.contact_force;
  }
  if (hht.head_imposed()) {
    s.v[U1] = b0.velocity;
    s.contact_force = hht.reaction(b0, s.internal);
  }
  s.boundary = b0;
}

const Signal& position_input(Drive drive, const Inputs& u) {
  return drive == Drive::Wire ? u.wire_height : u.head_displacement;
}

void set_forces(const Inputs& u, double tau, Boundary& b) {
  b.uplift = {u.uplift.head.at(tau), u.uplift.upper_frame.at(tau), u.uplift.lower_frame.at(tau)};
  b.contact_force = u.contact_force.at(tau);
}

double largest_internal_step(const Parameters& p, const Held& held) {
  return p.drive == Drive::Bench ? Bench::grid_step(held.bench.frequency, p.solver.step) : p.solver.step;
}

}  // namespace zspring
