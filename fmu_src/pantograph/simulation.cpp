#include "simulation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "linearized_step.hpp"

namespace zspring {
namespace {

constexpr int most_halvings = 10;          // to 1/1024 of the internal step
constexpr double rounding_of_time = 1e-6;  // of an internal step: hosts add up their communication points

void set_forces(const Inputs& u, double tau, Boundary& b) {
  for (int k = 0; k < 3; ++k) b.uplift[k] = u.uplift[k].at(tau);
  b.contact_force = u.contact_force.at(tau);
}

const Signal& position_input(Drive drive, const Inputs& u) {
  return drive == Drive::Wire ? u.wire_height : u.head_displacement;
}

}  // namespace

Simulation::Simulation(const Parameters& parameters, const Inputs& inputs)
    : mechanics_(parameters), hht_(mechanics_) {
  state_.mechanical = at_rest(inputs);
  state_.motion.position = state_.mechanical.boundary.position;
  before_ = state_;
  held_.inputs = inputs;
  if (!is_finite()) throw ParameterError(overflow);
}

Boundary Simulation::initial_boundary(const Inputs& u) const {
  Boundary b;
  for (int k = 0; k < 3; ++k) b.uplift[k] = u.uplift[k].value;
  b.contact_force = u.contact_force.value;
  // The wire begins where it is; the head begins in the static state, whatever its target.
  if (mechanics_.parameters.drive == Drive::Wire) b.position = u.wire_height.value;
  return b;
}

MechanicalState Simulation::at_rest(const Inputs& inputs) const {
  MechanicalState s;
  Matrix4 tangent;
  s.q = mechanics_.rest;
  mechanics_.springs(s.q, s.internal, tangent);
  s.boundary = initial_boundary(inputs);
  bool closed;
  s.contact_force =
      hht_.head_imposed() ? hht_.reaction(s.boundary, s.internal) : hht_.head_force(s.boundary, 0, 0, closed);
  s.a = acceleration(hht_, s);
  return s;
}

// What jumps at a communication point. A force takes HHT's memory of the acceleration with it; else the first step
// would still feel the old force, an error of first order. An imposed velocity costs the work of an impulse.
void Simulation::meet(const Boundary& b0, MechanicalState& s) const {
  if (hht_.head_imposed()) s.work += 0.5 * mechanics_.mass[U1] * (b0.velocity * b0.velocity - s.v[U1] * s.v[U1]);
  meet_variation(b0, s);
}

// The linear part of it, of values or of their variations.
void Simulation::meet_variation(const Boundary& b0, MechanicalState& s) const {
  const Vector5& mass = mechanics_.mass;
  for (int k = 0; k < 3; ++k)
    if (mass[mass_dof[k]] > 0) s.a[mass_dof[k]] += (b0.uplift[k] - s.boundary.uplift[k]) / mass[mass_dof[k]];
  if (mechanics_.parameters.drive == Drive::Force) {
    s.a[U1] -= (b0.contact_force - s.contact_force) / mass[U1];
    s.contact_force = b0.contact_force;
  }
  if (hht_.head_imposed()) {
    s.v[U1] = b0.velocity;
    s.contact_force = hht_.reaction(b0, s.internal);
  }
  s.boundary = b0;
}

template <class BoundaryAt, class OnStep>
bool Simulation::cover(MechanicalState& s, const BoundaryAt& boundary, const Boundary& b0, const Boundary& b1,
                       double begin, double h, int halvings, OnStep& on_step, Unsolved& unsolved) const {
  MechanicalState next;
  const double h_last = s.h;
  hht_.prepare(h, h_last, s);
  if (hht_.step(s, b0, b1, h, next, unsolved.step)) {
    on_step(s, next, b0, b1, h);
    s = next;
    return true;
  }
  hht_.prepare(h_last, h, s);
  s.statistics = next.statistics;
  unsolved.time = begin;
  if (halvings == most_halvings) return false;
  s.statistics.refinements += 1;
  Boundary middle;
  boundary(begin + 0.5 * h, middle);
  return cover(s, boundary, b0, middle, begin, 0.5 * h, halvings + 1, on_step, unsolved) &&
         cover(s, boundary, middle, b1, begin + 0.5 * h, 0.5 * h, halvings + 1, on_step, unsolved);
}

template <class OnStep>
bool Simulation::run(SimulationState& state, const Held& held, OnStep&& on_step, Unsolved& unsolved) const {
  return mechanics_.parameters.drive == Drive::Bench ? run_bench(state, held, on_step, unsolved)
                                                     : run_inputs(state, held, on_step, unsolved);
}

template <class OnStep>
bool Simulation::run_bench(SimulationState& state, const Held& held, OnStep& on_step, Unsolved& unsolved) const {
  const Parameters& p = mechanics_.parameters;
  MechanicalState& s = state.mechanical;
  Bench bench(state.bench);
  bench.tune(held.bench_frequency, held.bench_acceleration, p.solver.step);
  const double rounding = rounding_of_time * bench.grid_step();
  const double end_time = held.length + state.bench.carry;
  double done = 0;                          // s since the begin of the communication step, at a node or a cut
  double next_node = bench.to_next_node();  // s likewise; counted from the first, so that rounding does not add up
  const double first_node = next_node;
  double nodes = 0;

  Boundary b0, b1;
  const auto boundary = [&](double tau, Boundary& b) {
    set_forces(held.inputs, tau, b);
    bench.motion(tau - done, b);
  };
  set_forces(held.inputs, 0, b0);
  Phasor begin = bench.motion(0, b0);
  meet(b0, s);
  while (end_time - done > rounding) {
    const bool reaches_node = end_time >= next_node - rounding;
    const double h = reaches_node ? bench.to_next_node() : end_time - done;
    set_forces(held.inputs, done + h, b1);
    const Phasor end = bench.motion(h, b1);
    const double force = s.contact_force - p.static_force;
    if (!cover(s, boundary, b0, b1, done, h, 0, on_step, unsolved)) return false;
    bench.advance(h, reaches_node, begin, force, end, s.contact_force - p.static_force);
    b0 = b1;
    begin = end;
    done = reaches_node ? next_node : end_time;
    if (reaches_node) next_node = first_node + ++nodes * bench.grid_step();
  }
  state.bench.carry = end_time - done;
  return true;
}

template <class OnStep>
bool Simulation::run_inputs(SimulationState& state, const Held& held, OnStep& on_step, Unsolved& unsolved) const {
  const Parameters& p = mechanics_.parameters;
  const double H = held.length;
  MechanicalState& s = state.mechanical;
  const ImposedMotion motion(state.motion, position_input(p.drive, held.inputs), H);
  Boundary b0, b1;
  const auto boundary = [&](double tau, Boundary& b) {
    set_forces(held.inputs, tau, b);
    if (p.drive != Drive::Force) motion.at(tau, b);
  };
  const double n = std::max(1.0, std::ceil(H / p.solver.step - rounding_of_time));
  boundary(0, b0);
  meet(b0, s);
  for (double i = 0; i < n; ++i) {
    boundary((i + 1) / n * H, b1);
    if (!cover(s, boundary, b0, b1, i / n * H, H / n, 0, on_step, unsolved)) return false;
    b0 = b1;
  }
  if (p.drive != Drive::Force) state.motion = motion.end();
  return true;
}

double Simulation::largest_step(const Held& held) const {
  const Parameters& p = mechanics_.parameters;
  return p.drive == Drive::Bench ? Bench::grid_step(held.bench_frequency, p.solver.step) : p.solver.step;
}

bool Simulation::advance(const Parameters& tuned, const Inputs& inputs, double length, AdvanceFailure& failure) {
  const Held held{inputs, tuned.bench_frequency, tuned.bench_acceleration, length};
  if (too_long(length, largest_step(held), failure)) return false;
  const SimulationState begin = state_;
  const auto nothing = [](const MechanicalState&, const MechanicalState&, const Boundary&, const Boundary&,
                          double) {};
  Unsolved unsolved;
  const bool solved = run(state_, held, nothing, unsolved);
  if (!solved || !is_finite()) {
    state_ = begin;
    const StepFailure& f = unsolved.step;
    failure.time = unsolved.time;
    if (solved)
      std::snprintf(failure.text, sizeof failure.text, overflow);
    else if (!std::isfinite(f.residual))
      std::snprintf(failure.text, sizeof failure.text,
                    "no solution even after halving the internal step to 1/1024: the spring would have no length, "
                    "or the values overflow");
    else
      std::snprintf(failure.text, sizeof failure.text,
                    "no solution even after halving the internal step to 1/1024; %s: unbalanced by %.3g %s, "
                    "iterations: %d",
                    dof_name[f.dof], f.residual, f.dof == ALPHA || f.dof == BETA ? "N.m" : "N", f.iterations);
    return false;
  }
  before_ = begin;
  held_ = held;
  return true;
}

// The accelerations of HHT are its own; no output shows them.
bool Simulation::is_finite() const {
  const MechanicalState& s = state_.mechanical;
  return all_finite(outputs()) && s.a.allFinite() && s.a_slope.allFinite();
}

bool Simulation::is_possible() const {
  for (const SimulationState* s : {&state_, &before_}) {
    const Statistics& n = s->mechanical.statistics;
    if (!(n.iterations >= 0 && n.iterations_max >= 0 && n.steps >= 0 && n.refinements >= 0 &&
          s->mechanical.h >= 0 && s->motion.positions.is_possible() && s->motion.curvatures.is_possible() &&
          s->bench.is_possible(mechanics_.parameters.solver.step)))
      return false;
  }
  AdvanceFailure unused;
  return held_.length == 0 || (held_.length > 0 && !too_long(held_.length, largest_step(held_), unused));
}

void Simulation::describe_run(char* text, int size) const {
  const Statistics& n = state_.mechanical.statistics;
  std::snprintf(text, static_cast<size_t>(size),
                "%.0f steps, %.3g iterations a step, at most %.0f, %.0f refinements", n.steps,
                n.steps > 0 ? n.iterations / n.steps : 0, n.iterations_max, n.refinements);
}

const char* Simulation::describe_step(char* text, int size) const {
  const double halvings = state_.mechanical.statistics.refinements - before_.mechanical.statistics.refinements;
  if (halvings == 0) return nullptr;
  std::snprintf(text, static_cast<size_t>(size), "%.0f halvings of the internal step", halvings);
  return text;
}

Outputs Simulation::output_rates() const {
  const MechanicalState& s = state_.mechanical;
  MechanicalState d;
  if (held_.length > 0) {
    SimulationState again = before_;
    Unsolved unsolved;
    const auto quotient = [&](const MechanicalState& from, const MechanicalState& to, const Boundary& b0,
                              const Boundary& b1, double h) {
      d.internal = (to.internal - from.internal) / h;
      d.s = (to.s - from.s) / h;
      d.contact_force = (to.contact_force - from.contact_force) / h;
      d.boundary.uplift = (b1.uplift - b0.uplift) / h;
      d.boundary.acceleration = (b1.acceleration - b0.acceleration) / h;
      d.boundary.acceleration_change = (b1.acceleration_change - b0.acceleration_change) / h;
    };
    run(again, held_, quotient, unsolved);
  }
  d.q = s.v;
  d.v = acceleration(hht_, s);
  d.dissipated = s.loss_power;
  d.work = s.v.dot(mechanics_.preload + hht_.push(s.boundary, s.contact_force));
  return zspring::outputs_change(hht_, s, d);
}

Outputs Simulation::outputs_change(const Inputs& direction) const {
  const Parameters& p = mechanics_.parameters;
  const MechanicalState& s = state_.mechanical;
  if (held_.length == 0) {
    MechanicalState d;
    d.boundary = initial_boundary(direction);
    if (p.drive == Drive::Force) d.contact_force = d.boundary.contact_force;
    if (p.drive == Drive::Wire) d.contact_force = s.contact_force > 0 ? -p.contact_k * d.boundary.position : 0;
    if (hht_.head_imposed()) d.contact_force = d.boundary.uplift[0];
    return zspring::outputs_change(hht_, s, d);
  }
  // Only values vary; the way a position moves does not.
  Inputs du = direction;
  Signal& position = p.drive == Drive::Wire ? du.wire_height : du.head_displacement;
  const Signal& held_position = position_input(p.drive, held_.inputs);
  position.has_derivatives = held_position.has_derivatives;
  position.has_curvature = held_position.has_curvature;
  const ImposedMotion motion(before_.motion.variation(), position, held_.length);
  const bool moves = p.drive == Drive::Displacement || p.drive == Drive::Wire;

  const auto boundary_change = [&](double tau) {
    Boundary b;
    for (int k = 0; k < 3; ++k) b.uplift[k] = du.uplift[k].value;
    b.contact_force = du.contact_force.value;
    if (moves) motion.at(tau, b);
    return b;
  };
  MechanicalState d;
  Boundary db0 = boundary_change(0);
  meet_variation(db0, d);
  if (p.drive == Drive::Displacement) {
    Boundary b0;
    ImposedMotion(before_.motion, held_position, held_.length).at(0, b0);
    d.work = mechanics_.mass[U1] * b0.velocity * db0.velocity;
  }
  double tau = 0;
  const auto linearized = [&](const MechanicalState& from, const MechanicalState& to, const Boundary& b0,
                              const Boundary& b1, double h) {
    tau += h;
    hht_.prepare(h, from.h, d);
    const Boundary db1 = boundary_change(tau);
    d = linearized_step(hht_, from, b0, b1, h, to, d, db0, db1);
    db0 = db1;
  };
  SimulationState again = before_;
  Unsolved unsolved;
  run(again, held_, linearized, unsolved);
  return zspring::outputs_change(hht_, s, d);
}

const char* Simulation::describe_imbalance(char* text, int size) const {
  const Parameters& p = mechanics_.parameters;
  const Inputs& u = held_.inputs;
  const auto describe = [&](const char* name, double value, const char* unit, double balanced) {
    std::snprintf(
        text, static_cast<size_t>(size),
        "%s = %g %s: the static state, where the simulation starts, has %g %s; the motion starts with a step",
        name, value, unit, balanced, unit);
    return text;
  };
  if (p.drive == Drive::Force && u.contact_force.value != p.static_force)
    return describe("contact_force", u.contact_force.value, "N", p.static_force);
  if (p.drive == Drive::Displacement && u.head_displacement.value != 0)
    return describe("head_displacement", u.head_displacement.value, "m", 0);
  if (p.drive == Drive::Wire && u.wire_height.value != 0)
    return describe("wire_height", u.wire_height.value, "m", 0);
  const char* names[] = {"uplift.head", "uplift.upper_frame", "uplift.lower_frame"};
  for (int k = 0; k < 3; ++k)
    if (u.uplift[k].value != 0 && !(k == 0 && hht_.head_imposed()))
      return describe(names[k], u.uplift[k].value, "N", 0);
  return nullptr;
}

}  // namespace zspring
