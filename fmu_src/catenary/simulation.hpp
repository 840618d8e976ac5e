// A simulation: the line from its equilibrium under the first contact forces, communication step by step.
#pragma once

#include "communication_step.hpp"
#include "hht.hpp"

namespace zspring::catenary {

class Simulation {
 public:
  // Throws ParameterError.
  Simulation(const Parameters& parameters, const Inputs& inputs);
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  // Over `length` > 0 s. False, with the state as before, where a pantograph that presses leaves the line, or
  // where the slack droppers could not be found.
  bool advance(const Parameters&, const Inputs& inputs, double length, AdvanceFailure& failure);

  Outputs outputs() const;
  // d outputs / d time at the end of the last communication step; of velocities that of HHT, of first order.
  Outputs output_rates() const;
  // Variation of the outputs with that of the inputs' values held in the last communication step; before the
  // first one, with that of the initial inputs.
  Outputs outputs_change(const Inputs& direction);

  const char* describe_imbalance(char*, int) const { return nullptr; }  // it starts in equilibrium
  void describe_run(char* text, int size) const;
  const char* describe_step(char*, int) const { return nullptr; }

  const LineFacts& calculated() const { return facts_; }

  // Numbers in fixed order, each given to f as a double or a vector of them.
  template <class Visitor>
  void visit_state(Visitor&& f) {
    visit(state_, f);
    visit(before_, f);
    visit(held_, f);
    f(length_);
  }
  // Whether these could be a simulation's: some of them are counts.
  bool is_possible() const;

 private:
  bool stays_on_line(const CommunicationStep& step, AdvanceFailure& failure) const;
  double dropper_force(int dropper) const;
  // derivatives.cpp
  Outputs change(const LineState& d) const;

  Line line_;
  Hht hht_;
  LineState state_, before_;  // before_: at the begin of the last communication step
  LineState next_;            // workspace
  Inputs held_;               // in the last communication step
  double length_ = 0;         // s, of that; 0 before the first
  LineFacts facts_;
};

}  // namespace zspring::catenary
