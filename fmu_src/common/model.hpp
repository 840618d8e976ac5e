// What the FMI layer needs of a model, and what models have in common.
#pragma once

#include <cstddef>
#include <optional>

#include "numbers.hpp"
#include "outputs.hpp"
#include "time.hpp"

namespace zspring {

// A model's Table is a file of the FMU's resources that a copy of it may have: it stands in for some of the parameters.
// This is the one of models that know none.
struct NoTable {
  static constexpr char name[] = "";  // of the file, NAME.table
  static bool replaces(const char* /*parameter*/) { return false; }
  static NoTable of(const char* /*bytes*/, std::size_t /*size*/) { return {}; }
};

// A simulation, communication step by communication step, from the initial state that its constructor makes of
// (const Parameters&, const Inputs&, const Table*), null for none; that throws Refusal for what makes no model. It
// keeps no copy of the parameters: of those referred to, the tunable ones may change between steps.
//
// State is all that changes; Held, with `inputs` and `length`, what holds during one communication step.
// Simulation is the model itself, a final class, so that its functions are called directly.
template <class Simulation, class Inputs, class State, class Held>
class Model {
 public:
  Model() = default;
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  // Over `length` > 0 s. Does not allocate. A leftover of a step, as hosts that add up their times make one before the
  // stop, is no step: an input that is to be reached within it would jump. Its time waits for the next step.
  std::optional<Discard> advance(const Inputs& inputs, double length) {
    Simulation& self = static_cast<Simulation&>(*this);
    length += waiting_;
    if (is_leftover(length, self.solver_step())) {
      waiting_ = length;
      return std::nullopt;
    }
    const Held held = self.hold(inputs, length);
    if (std::optional<Discard> discard = too_long(length, self.largest_internal_step(held))) return discard;
    std::optional<Discard> discard = self.run(held);
    if (!discard) {
      std::swap(state_, next_);
      forget_outputs();
      if (all_finite(outputs())) {
        std::swap(before_, next_);
        held_ = held;
        waiting_ = 0;
        return std::nullopt;
      }
      std::swap(state_, next_);
      forget_outputs();
      discard = Discard{length, text("%s", overflow)};
    }
    self.went_back();
    return discard;
  }

  // At the end of the last step; made once for each state.
  const Outputs& outputs() {
    if (!outputs_) outputs_ = static_cast<Simulation&>(*this).present_outputs();
    return *outputs_;
  }
  // To be called where parameters changed.
  void forget_outputs() { outputs_.reset(); }
  // d outputs / d time at the end of the last step.
  virtual Outputs output_rates() = 0;
  // Variation of the outputs with that of the inputs' values held in the last step; before the first one, with
  // that of the initial inputs; nothing after a leftover, in which no input acted.
  virtual Outputs outputs_change(const Inputs& direction) = 0;

  // For the log: what does not fit together at the start; what the solver did in the whole simulation; what it did
  // in the last step, where that is unusual.
  virtual std::optional<Text> describe_imbalance() const { return std::nullopt; }
  virtual Text describe_run() const = 0;
  virtual std::optional<Text> describe_step() const { return std::nullopt; }
  // What made the last step less accurate than it should be; said once.
  virtual std::optional<Text> describe_doubt() const { return std::nullopt; }
  // Why who reads this output is not told what he asks for; said once.
  virtual std::optional<Text> describe_reading(Id) const { return std::nullopt; }

  // All of the state but the parameters.
  void write(Writer& writer) { visit_all(writer); }
  // Throws Refusal where these numbers are those of no simulation.
  void restore(Reader& reader) {
    visit_all(reader);
    forget_outputs();
    went_back();
    const bool waits = waiting_ == 0 || (waiting_ > 0 && is_leftover(waiting_, solver_step()));
    if (!(is_possible(state_) && is_possible(before_) && held_.length >= 0 && waits) ||
        too_long(held_.length, largest_internal_step(held_)) || !all_finite(outputs()))
      refuse("FMU state: holds numbers that no simulation leaves behind");
  }

 protected:
  ~Model() = default;

  // To be called by the constructor: the simulation begins in this state.
  void begin(State state, Held held) {
    state_ = before_ = next_ = std::move(state);
    held_ = std::move(held);
    waiting_ = 0;
    if (!all_finite(outputs())) refuse(overflow);
  }

  bool ended_with_leftover() const { return waiting_ > 0; }
  virtual Held hold(const Inputs& inputs, double length) const = 0;
  virtual double solver_step() const = 0;  // s
  virtual double largest_internal_step(const Held& held) const = 0;
  // Leads state_, which is kept, through a communication step to next_, of which nothing is left as it was; to anywhere
  // if that is discarded.
  virtual std::optional<Discard> run(const Held& held) = 0;
  // The state is not the one that run() led to last.
  virtual void went_back() {}
  virtual Outputs present_outputs() const = 0;
  virtual bool is_possible(const State& state) const = 0;  // whether what was read could be a simulation's

  State state_, before_;  // before_: at the begin of the last communication step
  Held held_;             // in that; of length 0 before the first
  State next_;            // at the end of a step under way

 private:
  template <class Visitor>
  void visit_all(Visitor& visitor) {
    visit(state_, visitor), visit(before_, visitor), visit(held_, visitor), visit(waiting_, visitor);
  }

  double waiting_ = 0;  // s, of leftovers since the last step
  std::optional<Outputs> outputs_;
};

}  // namespace zspring
