#include "communication_step.hpp"

#include <algorithm>
#include <cmath>

namespace zspring {
namespace {

constexpr auto nothing = [](const MechanicalState&, const MechanicalState&) {};  // to see of an internal step

}  // namespace

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

std::optional<Discard> CommunicationStep::run(SimulationState& state) const {
  return gives_way() ? meet_wire(state) : run_along(position_input(p_.drive, held_.inputs), state, nothing);
}

// A wire that gives way is at free + compliance F at the end of the step, F the force there after all internal steps
// with the wire on its straight way. F falls as the wire rises, so that
//
//   residual(height) = height - free - compliance F(height)
//
// grows at least as the height does: its root is no further than the residual. The secant method finds it, beginning
// with the stiffness of the contact.
std::optional<Discard> CommunicationStep::meet_wire(SimulationState& state) const {
  const Wire& wire = held_.inputs.wire;
  const double compliance = wire.compliance.value, force = state.mechanical.contact_force;
  const double free = held_.inputs.wire_height.at(held_.length) + wire.compliance_previous.value * force;
  const double allowed = p_.solver.tolerance * compliance * (p_.static_force + p_.m1 * p_.gravity);  // m
  double slope = 1 + compliance * p_.contact.k, low = -HUGE_VAL, high = HUGE_VAL;
  double last_height = 0, last_residual = 0;
  Signal height;
  height.value = free + compliance * force;
  for (int i = 0; i < most_meetings; ++i) {
    SimulationState end = state;
    if (std::optional<Discard> discard = run_inputs(end, height, nothing)) return discard;
    const double residual = height.value - free - compliance * end.mechanical.contact_force;
    if (std::abs(residual) <= allowed) {
      state = end;
      return std::nullopt;
    }
    low = std::max(low, residual > 0 ? height.value - residual : height.value);
    high = std::min(high, residual > 0 ? height.value : height.value - residual);
    if (i > 0) slope = std::max(1.0, (residual - last_residual) / (height.value - last_height));
    last_height = height.value;
    last_residual = residual;
    height.value -= residual / slope;
    if (!(height.value > low && height.value < high)) height.value = 0.5 * (low + high);
  }
  return Discard{0,
                 text("wire.compliance = %g m/N: no height of the wire fits the contact force, the residual is %.3g m",
                      compliance, last_residual)};
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
