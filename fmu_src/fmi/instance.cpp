#include "instance.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <utility>

namespace zspring::fmi {
namespace {

template <class... Values>
[[noreturn]] void refuse(const char* format, Values... values) {
  char text[512];
  std::snprintf(text, sizeof text, format, values...);
  throw Refusal(text);
}

// "m1 = -1 kg"
std::string described(const Variable& v, double x) {
  char text[160];
  const bool has_unit = *v.unit && std::strcmp(v.unit, "1") != 0;
  std::snprintf(text, sizeof text, "%s = %.10g%s%s", v.name, x, has_unit ? " " : "", has_unit ? v.unit : "");
  return text;
}

void check_value(const Variable& v, double x) {
  if (!std::isfinite(x)) refuse("%s: must be a finite number", described(v, x).c_str());
  if (v.type != Type::Real && x != std::round(x)) refuse("%s: must be a whole number", described(v, x).c_str());
  if (*v.allowed && (x < v.min || x > v.max)) refuse("%s: must be one of %s", described(v, x).c_str(), v.allowed);
  if (x < v.min) refuse("%s: must be at least %.10g", described(v, x).c_str(), v.min);
  if (x > v.max) refuse("%s: must be at most %.10g", described(v, x).c_str(), v.max);
}

double finite(const Variable& v, double derivative) {
  if (!std::isfinite(derivative)) refuse("%s: the derivative overflows", v.name);
  return derivative;
}

bool same_type(Type a, Type b) {
  const auto integer = [](Type t) { return t == Type::Enumeration ? Type::Integer : t; };
  return integer(a) == integer(b);
}

}  // namespace

const Variable& Instance::variable(unsigned reference, Type type) const {
  if (reference >= variable_count) refuse("value reference %u: must be below %u", reference, variable_count);
  const Variable& v = variables[reference];
  if (!same_type(v.type, type)) refuse("%s: is of type %s, not %s", v.name, type_name(v.type), type_name(type));
  return v;
}

void Instance::reset() {
  phase = Instantiated;
  for (const Variable& v : variables)
    if (v.is_parameter()) v.set(parameters_, v.start);
  inputs_ = {};
  for (const Variable& v : variables)
    if (v.is_input()) v.signal(inputs_).value = v.start;
  experiment_ = {};
  time_ = 0;
  stepped_ = false;
  forget_discard();
  simulation_.reset();
  outputs_.reset();
}

void Instance::setup_experiment(const Experiment& e) {
  if (!std::isfinite(e.start)) refuse("startTime = %g s: must be a finite number", e.start);
  if (e.has_stop && !(e.stop >= e.start))
    refuse("stopTime = %.10g s: must not be before startTime = %.10g s", e.stop, e.start);
  experiment_ = e;
  if (std::isinf(e.stop)) experiment_.has_stop = false, experiment_.stop = 0;
  time_ = e.start;
}

void Instance::enter_initialization() { phase = Initialization; }

void Instance::exit_initialization() {
  simulation();
  phase = StepComplete;
}

void Instance::terminate() {
  char text[160];
  simulation().describe_run(text, sizeof text);
  log.write(fmi2OK, Category::logSolver, text);
  phase = Terminated;
}

Simulation& Instance::simulation() {
  if (!simulation_) {
    simulation_.emplace(parameters_, inputs_);
    modelled_ = parameters_;
    outputs_.reset();
  }
  return *simulation_;
}

bool Instance::is_model_of(const Parameters& p) const {
  return std::all_of(std::begin(variables), std::end(variables), [&](const Variable& v) {
    return !v.is_parameter() || v.tunable || v.get(modelled_) == v.get(p);
  });
}

double Instance::get(unsigned reference, Type type) {
  const Variable& v = variable(reference, type);
  if (v.is_parameter()) return v.get(parameters_);
  if (v.is_input()) return v.signal(inputs_).value;
  if (v.binding.calculated) return v.get(simulation().calculated());
  Simulation& s = simulation();
  if (!outputs_) outputs_ = s.outputs();
  const double y = v.get(*outputs_);
  return type == Type::Real ? y : std::min<double>(y, std::numeric_limits<fmi2Integer>::max());
}

void Instance::check_settable(const Variable& v) const {
  if (v.causality == Causality::Output || v.causality == Causality::CalculatedParameter)
    refuse("%s: is calculated by the FMU and cannot be set", v.name);
  if (v.causality == Causality::Parameter && !v.tunable && !(phase & (Instantiated | Initialization)))
    refuse("%s: is a fixed parameter and can be set before the end of initialization only", v.name);
}

void Instance::set(const fmi2ValueReference references[], size_t n, Type type, const double values[]) {
  for (size_t i = 0; i < n; ++i) {
    const Variable& v = variable(references[i], type);
    check_settable(v);
    check_value(v, values[i]);
  }
  discarded_length_ = 0;
  for (size_t i = 0; i < n; ++i) {
    const Variable& v = variables[references[i]];
    if (v.is_parameter())
      v.set(parameters_, values[i]);
    else
      v.signal(inputs_).value = values[i];
  }
  if (phase & (Instantiated | Initialization)) simulation_.reset();
}

void Instance::set_input_derivatives(const fmi2ValueReference references[], size_t n, const fmi2Integer orders[],
                                     const double values[]) {
  for (size_t i = 0; i < n; ++i) {
    const Variable& v = variable(references[i], Type::Real);
    if (!v.is_input()) refuse("%s: is no input and has no input derivatives", v.name);
    if (orders[i] != 1 && orders[i] != 2) refuse("%s: derivative of order %d; must be 1 or 2", v.name, orders[i]);
    if (!std::isfinite(values[i]))
      refuse("%s: derivative of order %d = %g: must be a finite number", v.name, orders[i], values[i]);
  }
  for (size_t i = 0; i < n; ++i) {
    Signal& s = variables[references[i]].signal(inputs_);
    (orders[i] == 1 ? s.rate : s.curvature) = values[i];
    s.has_derivatives = true;
    if (orders[i] == 2) s.has_curvature = true;
  }
}

void Instance::output_derivatives(const fmi2ValueReference references[], size_t n, const fmi2Integer orders[],
                                  double values[]) {
  for (size_t i = 0; i < n; ++i) {
    const Variable& v = variable(references[i], Type::Real);
    if (!v.binding.output) refuse("%s: is no output and has no output derivatives", v.name);
    if (orders[i] != 1) refuse("%s: derivative of order %d; must be 1", v.name, orders[i]);
  }
  const Outputs rates = simulation().output_rates();
  for (size_t i = 0; i < n; ++i) {
    const Variable& v = variables[references[i]];
    values[i] = finite(v, v.get(rates));
  }
}

void Instance::directional_derivative(const fmi2ValueReference unknown[], size_t n_unknown,
                                      const fmi2ValueReference known[], size_t n_known, const double direction[],
                                      double result[]) {
  Inputs change;
  for (size_t i = 0; i < n_known; ++i) {
    const Variable& v = variable(known[i], Type::Real);
    if (!v.is_input()) refuse("%s: must be an input to be known in a directional derivative", v.name);
    if (!std::isfinite(direction[i])) refuse("%s: direction = %g: must be a finite number", v.name, direction[i]);
    v.signal(change).value = direction[i];
  }
  for (size_t i = 0; i < n_unknown; ++i) {
    const Variable& v = variable(unknown[i], Type::Real);
    if (v.is_parameter() || v.is_input())
      refuse("%s: must be an output to be unknown in a directional derivative", v.name);
  }
  const Outputs y = simulation().outputs_change(change);
  for (size_t i = 0; i < n_unknown; ++i) {
    const Variable& v = variables[unknown[i]];
    result[i] = v.binding.output ? finite(v, v.get(y)) : 0;
  }
}

fmi2Status Instance::step(double from, double length) {
  if (!(length > 0) || !std::isfinite(length)) refuse("communicationStepSize = %.10g s: must be above 0", length);
  // Hosts add up their communication points; a difference that small moves nothing.
  const double rounding = 1e-4 * length + 1e-12 * std::abs(time_);
  if (!(std::abs(from - time_) <= rounding))
    refuse("currentCommunicationPoint = %.17g s: must be %.17g s, where the last step ended", from, time_);
  const double to = from + length;
  if (experiment_.has_stop && to > experiment_.stop + rounding)
    refuse("communicationStepSize = %.10g s: leads to %.17g s, past stopTime = %.17g s", length, to,
           experiment_.stop);

  char text[320];
  Simulation& s = *simulation_;
  if (!stepped_ && log.enabled(Category::logStatusWarning) && s.describe_imbalance(text, sizeof text))
    log.write(fmi2OK, Category::logStatusWarning, text);
  AdvanceFailure failure;
  outputs_.reset();
  if (!s.advance(parameters_, inputs_, length, failure)) {
    phase = StepFailed;
    wants_to_end_ = failure.at_end || length == discarded_length_;
    discarded_length_ = length;
    std::snprintf(text, sizeof text, "t = %.10g s: %s. The state is that of %.10g s", from + failure.time,
                  failure.text, time_);
    log.write(fmi2Discard, Category::logStatusDiscard, text);
    return fmi2Discard;
  }
  stepped_ = true;
  forget_discard();
  phase = StepComplete;
  time_ = to;
  if (log.enabled(Category::logSolver)) {
    const int n = std::snprintf(text, sizeof text, "t = %.10g s: ", time_);
    if (s.describe_step(text + n, static_cast<int>(sizeof text) - n)) log.write(fmi2OK, Category::logSolver, text);
  }
  return fmi2OK;
}

template <class Visitor>
void Instance::visit_values(Visitor&& f) {
  for (const Variable& v : variables) {
    if (!v.is_parameter()) continue;
    double x = v.get(parameters_);
    f(x);
    check_value(v, x);
    v.set(parameters_, x);
  }
  visit(inputs_, f);
  f(experiment_.start), f(experiment_.stop), f(experiment_.has_stop), f(time_), f(stepped_);
}

namespace {

Phase phase_of(double number) {
  for (Phase p : {Instantiated, Initialization, StepComplete, StepFailed, Terminated, Error})
    if (number == p) return p;
  refuse("FMU state: %g is no state of an FMU", number);
}

struct Writer {
  std::vector<double>& out;
  void operator()(double x) { out.push_back(x); }
  void operator()(bool x) { out.push_back(x); }
  template <class Vector>
  void operator()(const Vector& x) {
    out.insert(out.end(), x.data(), x.data() + x.size());
  }
};

struct Reader {
  const double* in;
  const double* end;
  const double* next(std::ptrdiff_t n) {
    if (end - in < n) throw Refusal("FMU state: ends before all its values are there");
    return std::exchange(in, in + n);
  }
  void operator()(double& x) { x = *next(1); }
  void operator()(bool& x) { x = *next(1) != 0; }
  template <class Vector>
  void operator()(Vector& x) {
    std::copy_n(next(x.size()), x.size(), x.data());
  }
};

}  // namespace

std::vector<double> Instance::snapshot() {
  std::vector<double> numbers{static_cast<double>(phase)};
  Writer write{numbers};
  visit_values(write);
  // A simulation that parameters or inputs have outdated is not part of the state.
  write(simulation_.has_value());
  if (simulation_) simulation_->visit_state(write);
  return numbers;
}

void Instance::restore(const std::vector<double>& numbers) {
  Reader read{numbers.data(), numbers.data() + numbers.size()};
  double stored_phase;
  read(stored_phase);
  phase = phase_of(stored_phase);
  visit_values(read);
  bool has_simulation;
  read(has_simulation);
  outputs_.reset();
  forget_discard();
  // Hosts that iterate restore at every step: a model of the same parameters is kept, only its state is replaced.
  if (!has_simulation || (simulation_ && !is_model_of(parameters_))) simulation_.reset();
  if (has_simulation) simulation().visit_state(read);
  if (read.in != read.end) throw Refusal("FMU state: goes on after its last value");
}

void Instance::check_state(const std::vector<double>& numbers) {
  for (double x : numbers)
    if (!std::isfinite(x)) throw Refusal("FMU state: holds a value that is not finite");
  Instance trial({}, "", false);
  trial.restore(numbers);
  if (!trial.simulation_) {
    if (trial.phase & (StepComplete | StepFailed | Terminated)) throw Refusal("FMU state: lacks its simulation");
    return;
  }
  if (!trial.simulation_->is_possible() || !all_finite(trial.simulation_->outputs()))
    throw Refusal("FMU state: holds numbers that no simulation leaves behind");
}

}  // namespace zspring::fmi
