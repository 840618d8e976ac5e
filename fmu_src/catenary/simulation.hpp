// A simulation: the line from its equilibrium under the first contact forces, communication step by step.
#pragma once

#include "common/model.hpp"
#include "communication_step.hpp"
#include "hht.hpp"
#include "outputs.hpp"

namespace zspring::catenary {

class Simulation final : public Model<Parameters, Inputs> {
 public:
  Simulation(const Parameters& parameters, const Inputs& inputs);

  // Discarded where a pantograph that presses leaves the line, or the slack droppers could not be found.
  std::optional<Discard> advance(const Inputs& inputs, double length) override;

  // derivatives.cpp. Of velocities that of HHT, of first order.
  Outputs output_rates() override;
  Outputs outputs_change(const Inputs& direction) override;

  std::optional<Text> describe_imbalance() const override { return std::nullopt; }  // it starts in equilibrium
  Text describe_run() const override;
  std::optional<Text> describe_step() const override { return std::nullopt; }

  void write(Writer& writer) override { visit_state(writer); }

  const LineFacts& calculated() const { return facts_; }

 private:
  Outputs present_outputs() const override { return catenary::outputs({line_, state_}); }
  Outputs change(const LineState& d) const { return catenary::outputs_change({line_, state_}, d); }
  std::optional<Discard> leaves_line(const CommunicationStep& step) const;
  void read(Reader& reader) override { visit_state(reader); }
  bool is_possible() const override;
  template <class Visitor>
  void visit_state(Visitor& f) {
    visit(state_, f);
    visit(before_, f);
    visit(held_, f);
    f(length_);
  }

  Line line_;
  Hht hht_;
  LineState state_, before_;  // before_: at the begin of the last communication step
  LineState next_;            // workspace
  Inputs held_;               // in the last communication step
  double length_ = 0;         // s, of that; 0 before the first
  LineFacts facts_;
};

}  // namespace zspring::catenary
