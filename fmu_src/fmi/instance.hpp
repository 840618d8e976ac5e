// One FMU instance: its phase, its values and its simulation. Knows the rules of FMI 2.0, no physics.
//
// A call that breaks a rule throws Refusal before anything has changed; fmi2_functions.cpp turns it into a log
// line and fmi2Error.
#pragma once

#include <limits>
#include <memory>
#include <optional>

#include "log.hpp"
#include "origin.hpp"
#include "state_machine.hpp"
#include "states.hpp"
#include "variables.hpp"

namespace zspring::fmi {

// Throws Refusal where the variable cannot have this value.
void check_value(const Variable& v, double x);

class Instance {
 public:
  Instance(const fmi2CallbackFunctions& functions, const char* name, bool debug) : log(functions, name, debug) {
    reset();
  }
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  void begin_as(Origin origin, const char* resources);  // resources: their location as a host gives it
  void setup_experiment(double start, bool has_stop, double stop);
  void enter_initialization() { phase = Initialization; }
  void exit_initialization() { simulation(), phase = StepComplete; }
  void terminate();
  void reset();

  double get(unsigned reference, Type type);
  void check_settable(unsigned reference, Type type, double x) const;
  void set(unsigned reference, double x);  // once checked
  // All or nothing.
  void set_input_derivatives(const fmi2ValueReference references[], size_t n, const fmi2Integer orders[],
                             const double values[]);
  void output_derivatives(const fmi2ValueReference references[], size_t n, const fmi2Integer orders[], double values[]);
  void directional_derivative(const fmi2ValueReference unknown[], size_t n_unknown, const fmi2ValueReference known[],
                              size_t n_known, const double direction[], double result[]);

  fmi2Status step(double from, double length);
  double last_successful_time() const { return time_; }
  // After a discarded step: it went where the run ends, or was tried twice. Some hosts, fmpy among them, repeat a
  // discarded step for ever unless the FMU asks for the end.
  bool wants_to_end() const { return wants_to_end_; }

  // fmu_state.cpp. Everything but the log settings, as numbers.
  Numbers snapshot();
  void restore(const Numbers& numbers);
  // Throws where numbers from outside the process could not be restored.
  void check_state(const Numbers& numbers) const;

  Phase phase;
  Log log;
  States states;

 private:
  static constexpr double never = std::numeric_limits<double>::max();  // s; finite, as all numbers of a state are

  const Variable& variable(unsigned reference, Type type) const;
  Simulation& simulation();  // built anew where parameters or inputs changed before the first step
  void forget_discard() { wants_to_end_ = false, discarded_length_ = 0; }
  template <class Visitor>
  bool visit_values(Visitor&& f);

  Origin origin_;
  std::shared_ptr<const Table> table_;  // null for none
  Parameters parameters_;
  Inputs inputs_;
  double stop_;  // s
  double time_;
  bool stepped_;
  bool doubted_;  // and said so
  bool misread_;  // and said so
  bool wants_to_end_;
  double discarded_length_;               // s, of the last step if that was discarded; else 0
  std::optional<Simulation> simulation_;  // refers to parameters_
};

}  // namespace zspring::fmi
