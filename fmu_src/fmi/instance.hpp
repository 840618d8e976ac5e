// One FMU instance: its phase, its values and its simulation. Knows the rules of FMI 2.0, no physics.
//
// A call that breaks a rule throws Refusal before anything has changed; fmi2_functions.cpp turns it into a log
// line and fmi2Error.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "log.hpp"
#include "variables.hpp"

namespace zspring::fmi {

// The states of section 4.2.3, as bits so that a call can name those in which it is allowed.
enum Phase : unsigned {
  Instantiated = 1,
  Initialization = 2,
  StepComplete = 4,
  StepFailed = 8,  // after fmi2Discard; the state is that before the step, so stepping on is possible
  Terminated = 16,
  Error = 32,
};

class Refusal : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct Experiment {
  double start = 0;
  double stop = 0;
  bool has_stop = false;
};

class Instance {
 public:
  Instance(const fmi2CallbackFunctions& functions, const char* name, bool debug) : log(functions, name, debug) {
    reset();
  }

  void setup_experiment(const Experiment& e);
  void enter_initialization();
  void exit_initialization();
  void terminate();
  void reset();

  double get(unsigned reference, Type type);
  // All or nothing.
  void set(const fmi2ValueReference references[], size_t n, Type type, const double values[]);
  void set_input_derivatives(const fmi2ValueReference references[], size_t n, const fmi2Integer orders[],
                             const double values[]);
  void output_derivatives(const fmi2ValueReference references[], size_t n, const fmi2Integer orders[],
                          double values[]);
  void directional_derivative(const fmi2ValueReference unknown[], size_t n_unknown,
                              const fmi2ValueReference known[], size_t n_known, const double direction[],
                              double result[]);

  fmi2Status step(double from, double length);
  double last_successful_time() const { return time_; }
  // After a discarded step: it went where the run ends, or was tried twice. Some hosts, fmpy among them, repeat a
  // discarded step for ever unless the FMU asks for the end.
  bool wants_to_end() const { return wants_to_end_; }

  // Everything but the log settings, as numbers.
  std::vector<double> snapshot();
  void restore(const std::vector<double>& numbers);
  // Throws where numbers from outside the process could not be restored.
  static void check_state(const std::vector<double>& numbers);

  Phase phase;
  Log log;

 private:
  const Variable& variable(unsigned reference, Type type) const;
  void check_settable(const Variable& v) const;
  Simulation& simulation();  // built anew where parameters or inputs changed before the first step
  void forget_discard() { wants_to_end_ = false, discarded_length_ = 0; }
  bool is_model_of(const Parameters& p) const;
  template <class Visitor>
  void visit_values(Visitor&& f);

  Parameters parameters_;
  Inputs inputs_;
  Experiment experiment_;
  double time_;
  bool stepped_;
  bool wants_to_end_;
  double discarded_length_;  // s, of the last step if that was discarded; else 0
  std::optional<Simulation> simulation_;
  Parameters modelled_;             // of simulation_
  std::optional<Outputs> outputs_;  // of the present state, made when asked for
};

}  // namespace zspring::fmi
