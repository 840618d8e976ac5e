// A simulation: the pantograph from its static state, communication step by communication step.
#pragma once

#include "common/model.hpp"
#include "communication_step.hpp"

namespace zspring {

class Simulation final : public Model<Simulation, Inputs, SimulationState, Held> {
 public:
  // Starts at rest in the static state under the inputs' values.
  Simulation(const Parameters& parameters, const Inputs& inputs, const NoTable* = nullptr);

  // derivatives.cpp. Of what has no rate in the state (forces and friction moments that are reactions) difference
  // quotients over the last internal step.
  Outputs output_rates() override;
  Outputs outputs_change(const Inputs& direction) override;

  // The first input that the static state does not balance.
  std::optional<Text> describe_imbalance() const override;
  Text describe_run() const override;
  std::optional<Text> describe_step() const override;

  const Calculated& calculated() const { return mechanics_.calculated; }
  const Statistics& statistics() const { return state_.mechanical.statistics; }

 private:
  friend Model;

  Held hold(const Inputs& inputs, double length) const override {
    return {inputs, mechanics_.parameters.bench, length};
  }
  double solver_step() const override { return mechanics_.parameters.solver.step; }
  double largest_internal_step(const Held& held) const override {
    return zspring::largest_internal_step(mechanics_.parameters, held);
  }
  std::optional<Discard> run(const Held& held) override;
  Outputs present_outputs() const override;
  Outputs change(const MechanicalState& d) const;  // of the outputs, with that of the state
  bool is_possible(const SimulationState& s) const override;
  MechanicalState at_rest(const Inputs& inputs) const;
  Signal position_followed() const;
  Outputs initial_change(const Inputs& direction) const;
  MechanicalState state_change(const Inputs& direction, const Signal& followed, double position) const;
  Boundary initial_boundary(const Inputs& inputs) const;

  Mechanics mechanics_;
  Hht hht_;
};

}  // namespace zspring
