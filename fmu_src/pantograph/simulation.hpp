// A simulation: the pantograph from its static state, communication step by communication step.
#pragma once

#include "common/model.hpp"
#include "communication_step.hpp"
#include "outputs.hpp"

namespace zspring {

class Simulation final : public Model<Parameters, Inputs> {
 public:
  // Starts at rest in the static state under the inputs' values.
  Simulation(const Parameters& parameters, const Inputs& inputs);

  std::optional<Discard> advance(const Inputs& inputs, double length) override;

  // derivatives.cpp. Of what has no rate in the state (forces and friction moments that are reactions) difference
  // quotients over the last internal step.
  Outputs output_rates() override;
  Outputs outputs_change(const Inputs& direction) override;

  // The first input that the static state does not balance.
  std::optional<Text> describe_imbalance() const override;
  Text describe_run() const override;
  std::optional<Text> describe_step() const override;

  void write(Writer& writer) override { visit_state(writer); }

  const StaticStiffness& calculated() const { return mechanics_.stiffness; }
  const Statistics& statistics() const { return state_.mechanical.statistics; }

 private:
  View view() const { return {hht_, state_.mechanical, state_.bench}; }
  Outputs present_outputs() const override { return zspring::outputs(view()); }
  bool is_finite();
  void read(Reader& reader) override { visit_state(reader); }
  bool is_possible() const override;
  MechanicalState at_rest(const Inputs& inputs) const;
  Boundary initial_boundary(const Inputs& inputs) const;
  template <class Visitor>
  void visit_state(Visitor& f) {
    visit(state_, f);
    visit(before_, f);
    visit(held_, f);
  }

  Mechanics mechanics_;
  Hht hht_;
  SimulationState state_, before_;  // before_: at the begin of the last communication step
  Held held_;                       // in the last communication step
};

}  // namespace zspring
