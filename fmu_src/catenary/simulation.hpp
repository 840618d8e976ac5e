// A simulation: the line from its equilibrium under the first contact forces, communication step by step.
#pragma once

#include "affine_map.hpp"
#include "common/model.hpp"

namespace zspring::catenary {

struct SimulationState {
  LineState line;  // Exchange::Parallel: under forces that were guessed in the last step
  // Exchange::Parallel: at its begin, where they were known, and that step; of length 0 before the first.
  LineState known;
  Held guessed;
  AffineMap map[pantographs];  // of the next step
  double foreseen = 0;         // s, its length
  // Exchange::Parallel: whether the last step had been foreseen, and what share that left of the bounds of the forces
  // at its end; 1 otherwise.
  bool was_foreseen = false;
  double room = 1;
  double datum[pantographs] = {};  // m, of the heights under the pantographs
};
ZSPRING_MEMBERS(SimulationState, line, known, guessed, map, foreseen, was_foreseen, room, datum)

class Simulation final : public Model<Simulation, Inputs, SimulationState, Held> {
 public:
  // table: of the line; null: like spans, from the parameters.
  Simulation(const Parameters& parameters, const Inputs& inputs, const LineTable* table = nullptr);

  // derivatives.cpp. Of velocities that of HHT, of first order.
  Outputs output_rates() override;
  Outputs outputs_change(const Inputs& direction) override;

  Text describe_run() const override;
  std::optional<Text> describe_doubt() const override;
  std::optional<Text> describe_reading(Id output) const override;

  const Calculated& calculated() const { return calculated_; }

 private:
  friend Model;

  Held hold(const Inputs& inputs, double length) const override { return {inputs, length}; }
  double solver_step() const override { return line_.p.solver.step; }
  double largest_internal_step(const Held&) const override { return line_.p.solver.step; }
  // Discarded where a pantograph that presses leaves the line, or the slack droppers could not be found.
  std::optional<Discard> run(const Held& held) override;
  std::optional<Discard> leaves_line(const CommunicationStep& step) const;
  std::optional<Discard> run_sequential(const Held& told);
  std::optional<Discard> run_parallel(const Held& told);
  [[nodiscard]] bool correct_guess(const Held& told, const ForceChange& change, bool& corrected);
  [[nodiscard]] bool look_again();
  bool is_as_expected() const;
  std::optional<Discard> look_ahead(double length);
  void went_back() override { foresight_.forget(); }
  LineState at_rest(const Passage passage[pantographs]);
  Outputs present_outputs() const override;
  Outputs change(const LineState& d) const;  // of the outputs, with that of the line
  bool is_possible(const SimulationState& s) const override;

  Line line_;
  Hht hht_;
  Foresight foresight_;
  Variation varied_;  // workspace
  Calculated calculated_;
};

}  // namespace zspring::catenary
