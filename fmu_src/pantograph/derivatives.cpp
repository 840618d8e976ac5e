// Derivatives of the outputs, with respect to time and to the inputs: the last communication step is done again,
// and what is wanted taken from each internal step.
#include "simulation.hpp"

namespace zspring {

Outputs Simulation::output_rates() {
  const MechanicalState& s = state_.mechanical;
  MechanicalState d;
  if (held_.length > 0) {
    SimulationState again = before_;
    const auto quotient = [&](const MechanicalState& from, const MechanicalState& to) {
      const Boundary &b0 = from.boundary, &b1 = to.boundary;
      d.internal = (to.internal - from.internal) / to.h;
      d.s = (to.s - from.s) / to.h;
      d.contact_force = (to.contact_force - from.contact_force) / to.h;
      d.boundary.uplift = (b1.uplift - b0.uplift) / to.h;
      d.boundary.acceleration = (b1.acceleration - b0.acceleration) / to.h;
      d.boundary.acceleration_change = (b1.acceleration_change - b0.acceleration_change) / to.h;
    };
    CommunicationStep(hht_, held_).run_along(position_followed(), again, quotient);
  }
  d.q = s.v;
  d.v = hht_.acceleration(s);
  d.dissipated = s.loss_power;
  d.work = s.v.dot(mechanics_.preload + hht_.push(s.boundary, s.contact_force));
  return change(d);
}

// In the last step.
Signal Simulation::position_followed() const {
  if (!CommunicationStep(hht_, held_).gives_way()) return position_input(mechanics_.parameters.drive, held_.inputs);
  Signal reached;
  reached.value = state_.motion.position;
  return reached;
}

Outputs Simulation::initial_change(const Inputs& direction) const {
  const Parameters& p = mechanics_.parameters;
  const MechanicalState& s = state_.mechanical;
  MechanicalState d;
  d.boundary = initial_boundary(direction);
  if (held_.inputs.wire.gives_way()) d.boundary.position = 0;
  if (p.drive == Drive::Force) d.contact_force = d.boundary.contact_force;
  if (p.drive == Drive::Wire) d.contact_force = s.contact_force > 0 ? -p.contact.k * d.boundary.position : 0;
  if (hht_.head_imposed()) d.contact_force = d.boundary.uplift[0];
  return change(d);
}

// Of the state, in the last step, with the values of the forces and of the position that was followed.
MechanicalState Simulation::state_change(const Inputs& direction, const Signal& followed, double position) const {
  const Parameters& p = mechanics_.parameters;
  // Only values vary; the way a position moves does not.
  Signal dposition = followed;
  dposition.value = position, dposition.rate = dposition.curvature = 0;
  const MotionState still = before_.motion.variation();
  const ImposedMotion motion(still, dposition, held_.length, resolved_time(p));
  const bool moves = p.drive == Drive::Displacement || p.drive == Drive::Wire;

  const auto boundary_change = [&](double tau) {
    Boundary b;
    set_forces(direction, tau, b);
    if (moves) motion.at(tau, b);
    return b;
  };
  MechanicalState d;
  const Boundary db0 = boundary_change(0);
  meet_variation(hht_, db0, d);
  if (p.drive == Drive::Displacement) {
    Boundary b0;
    ImposedMotion(before_.motion, followed, held_.length, resolved_time(p)).at(0, b0);
    d.work = mechanics_.mass[U1] * b0.velocity * db0.velocity;
  }
  double tau = 0;
  const auto differentiated = [&](const MechanicalState& from, const MechanicalState& to) {
    tau += to.h;
    move_memory(p.solver.hht_alpha, from.h, to.h, d.a_slope, d.a);
    d = hht_.step_variation(from, to, d, boundary_change(tau));
  };
  SimulationState again = before_;
  CommunicationStep(hht_, held_).run_along(followed, again, differentiated);
  return d;
}

Outputs Simulation::outputs_change(const Inputs& direction) {
  if (ended_with_leftover()) return {};
  if (held_.length == 0) return initial_change(direction);
  const Signal followed = position_followed();
  if (!CommunicationStep(hht_, held_).gives_way())
    return change(state_change(direction, followed, position_input(mechanics_.parameters.drive, direction).value));
  // A wire that gives way ends at free + compliance F: with its own variation there and the slope dF/d(height),
  // d height = d free + d compliance F + compliance dF.
  const double compliance = held_.inputs.wire.compliance.value;
  const double moved = direction.wire_height.value + direction.wire.compliance.value * state_.mechanical.contact_force +
                       direction.wire.compliance_previous.value * before_.mechanical.contact_force;
  const double first = state_change(direction, followed, moved).contact_force;
  const double slope = state_change({}, followed, 1).contact_force;
  return change(state_change(direction, followed, moved + compliance * first / (1 - compliance * slope)));
}

}  // namespace zspring
