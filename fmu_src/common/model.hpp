// What the FMI layer needs of a model.
#pragma once

#include <optional>

#include "failure.hpp"
#include "numbers.hpp"
#include "outputs.hpp"

namespace zspring {

// A simulation, communication step by communication step, from the initial state that its constructor makes of
// (const Parameters&, const Inputs&); that throws Refusal for what makes no model. It keeps no copy of the
// parameters: of those referred to, the tunable ones may change between steps.
template <class Parameters, class Inputs>
class Model {
 public:
  Model() = default;
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  // Over `length` > 0 s. Does not allocate.
  virtual std::optional<Discard> advance(const Inputs& inputs, double length) = 0;

  // At the end of the last step; made once for each state.
  const Outputs& outputs() {
    if (!outputs_) outputs_ = present_outputs();
    return *outputs_;
  }
  // To be called where parameters or state changed otherwise than by advance().
  void forget_outputs() { outputs_.reset(); }
  // d outputs / d time at the end of the last step.
  virtual Outputs output_rates() = 0;
  // Variation of the outputs with that of the inputs' values held in the last step; before the first one, with
  // that of the initial inputs.
  virtual Outputs outputs_change(const Inputs& direction) = 0;

  // For the log: what does not fit together at the start; what the solver did in the whole simulation; what it did
  // in the last step, where that is unusual.
  virtual std::optional<Text> describe_imbalance() const = 0;
  virtual Text describe_run() const = 0;
  virtual std::optional<Text> describe_step() const = 0;

  // All of the state but the parameters.
  virtual void write(Writer& writer) = 0;
  // Throws Refusal where these numbers are those of no simulation.
  void restore(Reader& reader) {
    read(reader);
    forget_outputs();
    if (!is_possible() || !all_finite(outputs()))
      refuse("FMU state: holds numbers that no simulation leaves behind");
  }

 protected:
  ~Model() = default;
  virtual Outputs present_outputs() const = 0;
  virtual void read(Reader& reader) = 0;
  virtual bool is_possible() const = 0;  // whether what was read could be a simulation's

 private:
  std::optional<Outputs> outputs_;
};

}  // namespace zspring
