// A simulation: the pantograph from its static state, communication step by communication step.
#pragma once

#include "bench.hpp"
#include "imposed_motion.hpp"
#include "outputs.hpp"

namespace zspring {

struct SimulationState {
  MechanicalState mechanical;
  MotionState motion;  // Drive::Displacement: the head; Drive::Wire: the wire
  BenchState bench;
};

// What holds during one communication step.
struct Held {
  Inputs inputs;
  double bench_frequency = 0, bench_acceleration = 0;
  double length = 0;  // s; 0 before the first step
};

struct Unsolved {
  double time = 0;  // s since the begin of the communication step
  StepFailure step;
};

class Simulation {
 public:
  // Starts at rest in the static state under the inputs' values. Throws ParameterError.
  Simulation(const Parameters& parameters, const Inputs& inputs);
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  // Over `length` > 0 s; of the parameters, those that are tunable may have changed. False, with the state as
  // before, where a step could not be solved even after halving.
  bool advance(const Parameters& tuned, const Inputs& inputs, double length, AdvanceFailure& failure);

  Outputs outputs() const { return zspring::outputs(hht_, state_.mechanical, state_.bench); }
  // d outputs / d time at the end of the last communication step; difference quotients over the last internal
  // step for what has no rate in the state (forces and friction moments that are reactions).
  Outputs output_rates() const;
  // Variation of the outputs with that of the inputs' values held in the last communication step; before the
  // first one, with that of the initial inputs.
  Outputs outputs_change(const Inputs& direction) const;

  // The first input that the static state does not balance, or null: "uplift.head = 3 N: ...".
  const char* describe_imbalance(char* text, int size) const;

  // What the solver did: in the whole simulation; in the last communication step, or null where that is usual.
  void describe_run(char* text, int size) const;
  const char* describe_step(char* text, int size) const;

  const StaticStiffness& calculated() const { return mechanics_.stiffness; }

  // Numbers in fixed order, each given to f as a double or a fixed-size vector of them.
  template <class Visitor>
  void visit_state(Visitor&& f);
  // Whether these could be a simulation's: some of them are counts.
  bool is_possible() const;

 private:
  bool is_finite() const;
  MechanicalState at_rest(const Inputs& inputs) const;
  Boundary initial_boundary(const Inputs& inputs) const;
  // Drives `state` through a communication step; on_step(from, to, b0, b1, h) sees each accepted internal step.
  template <class OnStep>
  bool run(SimulationState& state, const Held& held, OnStep&& on_step, Unsolved& unsolved) const;
  template <class OnStep>
  bool run_bench(SimulationState& state, const Held& held, OnStep& on_step, Unsolved& unsolved) const;
  template <class OnStep>
  bool run_inputs(SimulationState& state, const Held& held, OnStep& on_step, Unsolved& unsolved) const;
  // One internal step, halved as often as it takes.
  template <class BoundaryAt, class OnStep>
  bool cover(MechanicalState& s, const BoundaryAt& boundary, const Boundary& b0, const Boundary& b1, double begin,
             double h, int halvings, OnStep& on_step, Unsolved& unsolved) const;
  double largest_step(const Held& held) const;  // s
  void meet(const Boundary& b0, MechanicalState& s) const;
  void meet_variation(const Boundary& db0, MechanicalState& d) const;

  Mechanics mechanics_;
  Hht hht_;
  SimulationState state_, before_;  // before_: at the begin of the last communication step
  Held held_;                       // in the last communication step
};

template <class Visitor>
void visit(SimulationState& s, Visitor&& f) {
  visit(s.mechanical, f);
  visit(s.motion, f);
  visit(s.bench, f);
}

template <class Visitor>
void visit(Inputs& u, Visitor&& f) {
  visit(u.contact_force, f);
  visit(u.head_displacement, f);
  visit(u.wire_height, f);
  for (Signal& s : u.uplift) visit(s, f);
}

template <class Visitor>
void Simulation::visit_state(Visitor&& f) {
  visit(state_, f);
  visit(before_, f);
  visit(held_.inputs, f);
  f(held_.bench_frequency), f(held_.bench_acceleration), f(held_.length);
}

}  // namespace zspring
