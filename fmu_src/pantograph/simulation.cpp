#include "simulation.hpp"

#include <algorithm>
#include <cmath>

namespace zspring {
namespace {

Text no_wire(const Inputs& u) {
  const bool of_end = u.wire.compliance.value != 0;
  return text("%s = %g m/N: must be 0 but in drive Wire", of_end ? "wire.compliance" : "wire.compliance_previous",
              of_end ? u.wire.compliance.value : u.wire.compliance_previous.value);
}

}  // namespace

Simulation::Simulation(const Parameters& parameters, const Inputs& inputs, const NoTable*)
    : mechanics_(parameters), hht_(mechanics_) {
  SimulationState state;
  state.mechanical = at_rest(inputs);
  state.motion.position = state.mechanical.boundary.position;
  begin(state, {inputs, {}, 0});
}

Boundary Simulation::initial_boundary(const Inputs& u) const {
  Boundary b;
  set_forces(u, 0, b);
  // The wire begins where it is, the head in the static state, whatever its target. Of a wire that gives way only the
  // height at the end of the first step is told: it begins at 0, as in the static state.
  if (mechanics_.parameters.drive == Drive::Wire && !u.wire.gives_way()) b.position = u.wire_height.value;
  return b;
}

MechanicalState Simulation::at_rest(const Inputs& inputs) const {
  MechanicalState s;
  s.q = mechanics_.rest;
  ElementResponse head;
  if (mechanics_.head_response(s.q, head)) s.internal = mechanics_.spring_force(s.q, head);
  s.boundary = initial_boundary(inputs);
  s.contact_force = hht_.head_imposed() ? hht_.reaction(s.boundary, s.internal) : hht_.contact(s.boundary, 0, 0).force;
  s.a = hht_.acceleration(s);
  return s;
}

std::optional<Discard> Simulation::run(const Held& held) {
  if (held.inputs.wire.gives_way() && mechanics_.parameters.drive != Drive::Wire)
    return Discard{0, no_wire(held.inputs)};
  next_ = state_;
  std::optional<Discard> discard = CommunicationStep(hht_, held).run(next_);
  // The accelerations of HHT are its own; no output shows them.
  const MechanicalState& s = next_.mechanical;
  if (!discard && !(s.a.allFinite() && s.a_slope.allFinite())) discard = Discard{held.length, text("%s", overflow)};
  return discard;
}

bool Simulation::is_possible(const SimulationState& s) const {
  return s.mechanical.h >= 0 && s.motion.positions.is_possible() && s.motion.curvatures.is_possible() &&
         s.bench.is_possible(mechanics_.parameters.solver.step);
}

Text Simulation::describe_run() const {
  const Statistics& n = statistics();
  return text("%.0f steps, %.3g iterations a step, at most %.0f, %.0f refinements", static_cast<double>(n.steps),
              n.iterations_per_step(), static_cast<double>(n.iterations_max), static_cast<double>(n.refinements));
}

std::optional<Text> Simulation::describe_step() const {
  const Count halvings = statistics().refinements - before_.mechanical.statistics.refinements;
  if (halvings == 0) return std::nullopt;
  return text("%.0f halvings of the internal step", static_cast<double>(halvings));
}

std::optional<Text> Simulation::describe_imbalance() const {
  const Parameters& p = mechanics_.parameters;
  const Inputs& u = held_.inputs;
  // Of a wire that gives way its height under static_force, at the end of the first step: about 0.
  double wire = u.wire_height.value + (u.wire.compliance.value + u.wire.compliance_previous.value) * p.static_force;
  if (u.wire.gives_way() && std::abs(wire) < 1e-3) wire = 0;
  const struct {
    const char *name, *unit;
    bool acts;
    double value, balanced;
  } inputs[] = {
      {"contact_force", "N", p.drive == Drive::Force, u.contact_force.value, p.static_force},
      {"head_displacement", "m", p.drive == Drive::Displacement, u.head_displacement.value, 0},
      {u.wire.gives_way() ? "wire_height + (wire.compliance + wire.compliance_previous) static_force" : "wire_height",
       "m", p.drive == Drive::Wire, wire, 0},
      {"uplift.head", "N", !hht_.head_imposed(), u.uplift.head.value, 0},
      {"uplift.upper_frame", "N", true, u.uplift.upper_frame.value, 0},
      {"uplift.lower_frame", "N", true, u.uplift.lower_frame.value, 0},
  };
  for (const auto& i : inputs)
    if (i.acts && i.value != i.balanced)
      return text("%s = %g %s: the static state, where the simulation starts, has %g %s; the motion starts with a step",
                  i.name, i.value, i.unit, i.balanced, i.unit);
  return std::nullopt;
}

}  // namespace zspring
