#include "instance.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "common/checksum.hpp"
#include "resources.hpp"

namespace zspring::fmi {
namespace {

// "m1 = -1 kg"
Text described(const Variable& v, double x) {
  const bool has_unit = *v.unit && std::strcmp(v.unit, "1") != 0;
  return text("%s = %.10g%s%s", v.name, x, has_unit ? " " : "", has_unit ? v.unit : "");
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

void check_value(const Variable& v, double x) {
  if (!std::isfinite(x)) refuse("%s: must be a finite number", described(v, x).chars);
  if (v.type != Type::Real && x != std::round(x)) refuse("%s: must be a whole number", described(v, x).chars);
  if (*v.allowed && (x < v.min || x > v.max)) refuse("%s: must be one of %s", described(v, x).chars, v.allowed);
  if (x < v.min) refuse("%s: must be at least %.10g", described(v, x).chars, v.min);
  if (x > v.max) refuse("%s: must be at most %.10g", described(v, x).chars, v.max);
}

const Variable& Instance::variable(unsigned reference, Type type) const {
  if (reference >= variable_count) refuse("value reference %u: must be below %u", reference, variable_count);
  const Variable& v = variables[reference];
  if (!same_type(origin_.reals ? Type::Real : v.type, type))
    refuse("%s: is of type %s, not %s", v.name, type_name(v.type), type_name(type));
  return v;
}

void Instance::reset() {
  phase = Instantiated;
  inputs_ = {};
  for (unsigned i = 0; i < variable_count; ++i)
    if (!variables[i].is_calculated()) set(i, variables[i].start);
  for (const auto& [reference, value] : origin_.starts) set(reference, value);
  stop_ = never;
  time_ = 0;
  stepped_ = doubted_ = misread_ = false;
  forget_discard();
}

void Instance::begin_as(Origin origin, const char* resources) {
  origin_ = std::move(origin);
  if (origin_.table) {
    const std::string file = std::string(Table::name) + ".table";
    const std::string bytes = read_resource(resources, file.c_str());
    if (checksum(bytes.data(), bytes.size()) != *origin_.table)
      refuse("%s in the resources: is damaged, or not the one that this FMU was made with", file.c_str());
    table_ = std::make_shared<const Table>(Table::of(bytes.data(), bytes.size()));
  }
  reset();
}

void Instance::setup_experiment(double start, bool has_stop, double stop) {
  if (!std::isfinite(start)) refuse("startTime = %g s: must be a finite number", start);
  if (has_stop && !(stop >= start)) refuse("stopTime = %.10g s: must not be before startTime = %.10g s", stop, start);
  stop_ = has_stop ? std::min(stop, never) : never;
  time_ = start;
}

void Instance::terminate() {
  log.write(fmi2OK, Category::logSolver, simulation().describe_run());
  phase = Terminated;
}

Simulation& Instance::simulation() {
  if (!simulation_) simulation_.emplace(parameters_, inputs_, table_.get());
  return *simulation_;
}

double Instance::get(unsigned reference, Type type) {
  const Variable& v = variable(reference, type);
  if (v.is_parameter()) return v.get(parameters_);
  if (v.is_input()) return v.signal(inputs_).value;
  if (!v.is_output()) return v.get(simulation().calculated());
  const double y = v.get(simulation().outputs());
  if (!misread_ && log.enabled(Category::logStatusWarning))
    if (const std::optional<Text> why = simulation().describe_reading(id_of[v.binding.output])) {
      misread_ = true;
      log.write(fmi2OK, Category::logStatusWarning, text("%s: %s", v.name, why->chars));
    }
  return type == Type::Real ? y : std::min<double>(y, std::numeric_limits<fmi2Integer>::max());
}

void Instance::check_settable(unsigned reference, Type type, double x) const {
  const Variable& v = variable(reference, type);
  if (v.is_calculated()) refuse("%s: is calculated by the FMU and cannot be set", v.name);
  if (v.is_parameter() && !v.tunable && !(phase & before_start))
    refuse("%s: is a fixed parameter and can be set before the end of initialization only", v.name);
  check_value(v, x);
  if (v.is_parameter() && table_ && Table::replaces(v.name) && x != v.get(parameters_))
    refuse("%s: cannot be set, as this FMU has %s.table in its place", described(v, x).chars, Table::name);
}

void Instance::set(unsigned reference, double x) {
  const Variable& v = variables[reference];
  discarded_length_ = 0;
  if (v.is_parameter())
    v.set(parameters_, x);
  else
    v.signal(inputs_).value = x;
  if (phase & before_start)
    simulation_.reset();
  else
    simulation_->forget_outputs();
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
    if (!v.is_output()) refuse("%s: is no output and has no output derivatives", v.name);
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
    // Masters that know the dependencies alone, OMSimulator among them, name whatever an unknown depends on, be it an
    // enumeration, with a direction of 0.
    if (direction[i] == 0 && known[i] < variable_count) continue;
    const Variable& v = variable(known[i], Type::Real);
    if (!v.is_input()) refuse("%s: must be an input to be known in a directional derivative", v.name);
    if (!std::isfinite(direction[i])) refuse("%s: direction = %g: must be a finite number", v.name, direction[i]);
    v.signal(change).value = direction[i];
  }
  for (size_t i = 0; i < n_unknown; ++i) {
    const Variable& v = variable(unknown[i], Type::Real);
    if (!v.is_calculated()) refuse("%s: must be an output to be unknown in a directional derivative", v.name);
  }
  const Outputs y = simulation().outputs_change(change);
  for (size_t i = 0; i < n_unknown; ++i) {
    const Variable& v = variables[unknown[i]];
    result[i] = v.is_output() ? finite(v, v.get(y)) : 0;
  }
}

fmi2Status Instance::step(double from, double length) {
  if (!(length > 0) || !std::isfinite(length)) refuse("communicationStepSize = %.10g s: must be above 0", length);
  // Hosts add up their communication points; a difference that small moves nothing.
  const double rounding = 1e-4 * length + 1e-12 * std::abs(time_);
  if (!(std::abs(from - time_) <= rounding))
    refuse("currentCommunicationPoint = %.17g s: must be %.17g s, where the last step ended", from, time_);
  const double to = from + length;
  if (to > stop_ + rounding)
    refuse("communicationStepSize = %.10g s: leads to %.17g s, past stopTime = %.17g s", length, to, stop_);

  Simulation& s = *simulation_;
  if (!stepped_ && log.enabled(Category::logStatusWarning))
    if (const std::optional<Text> imbalance = s.describe_imbalance())
      log.write(fmi2OK, Category::logStatusWarning, *imbalance);
  if (const std::optional<Discard> discard = s.advance(inputs_, length)) {
    phase = StepFailed;
    wants_to_end_ = discard->at_end || length == discarded_length_;
    discarded_length_ = length;
    log.write(
        fmi2Discard, Category::logStatusDiscard,
        text("t = %.10g s: %s. The state is that of %.10g s", from + discard->time, discard->reason.chars, time_));
    return fmi2Discard;
  }
  stepped_ = true;
  forget_discard();
  phase = StepComplete;
  time_ = to;
  if (!doubted_ && log.enabled(Category::logStatusWarning))
    if (const std::optional<Text> doubt = s.describe_doubt()) {
      doubted_ = true;
      log.write(fmi2OK, Category::logStatusWarning, text("t = %.10g s: %s", time_, doubt->chars));
    }
  if (log.enabled(Category::logSolver))
    if (const std::optional<Text> step = s.describe_step())
      log.write(fmi2OK, Category::logSolver, text("t = %.10g s: %s", time_, step->chars));
  return fmi2OK;
}

}  // namespace zspring::fmi
