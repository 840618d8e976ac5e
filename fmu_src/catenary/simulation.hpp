// A simulation: the line from its equilibrium under the first contact forces, communication step by step.
#pragma once

#include "common/model.hpp"
#include "communication_step.hpp"
#include "hht.hpp"

namespace zspring::catenary {

class Simulation final : public Model<Simulation, Inputs, LineState, Held> {
 public:
  Simulation(const Parameters& parameters, const Inputs& inputs);

  // derivatives.cpp. Of velocities that of HHT, of first order.
  Outputs output_rates() override;
  Outputs outputs_change(const Inputs& direction) override;

  Text describe_run() const override;

  const Calculated& calculated() const { return calculated_; }

 private:
  friend Model;

  Held hold(const Inputs& inputs, double length) const override { return {inputs, length}; }
  double solver_step() const override { return line_.p.solver.step; }
  double largest_internal_step(const Held&) const override { return line_.p.solver.step; }
  // Discarded where a pantograph that presses leaves the line, or the slack droppers could not be found.
  std::optional<Discard> run(const Held& held) override;
  std::optional<Discard> leaves_line(const CommunicationStep& step) const;
  Outputs present_outputs() const override;
  Outputs change(const LineState& d) const;  // of the outputs, with that of the state
  bool is_possible(const LineState& s) const override;

  Line line_;
  Hht hht_;
  Calculated calculated_;
};

}  // namespace zspring::catenary
