// Getting and setting values, and derivatives.
#include <algorithm>

#include "subject.hpp"

namespace fuzz {
namespace {

// What keeps a single call short, where the variable exists: what it starts with, and how far it may be set.
struct CostBound {
  const char* name;
  double start, low, high;
};
constexpr CostBound cost_bounds[] = {{"solver.step", 2e-3, 1e-3, 0.1},
                                     {"solver.max_iterations", 50, 1, 100},
                                     {"line.spans", 2, 1, 3},
                                     {"mesh.element", 5, 3, HUGE_VAL}};

const CostBound* cost_bound(const Variable& v) {
  for (const CostBound& b : cost_bounds)
    if (std::strcmp(b.name, v.name) == 0) return &b;
  return nullptr;
}

double affordable(unsigned reference, double x) {
  if (reference >= variable_count || !(x >= variables[reference].min && x <= variables[reference].max)) return x;
  const CostBound* b = cost_bound(variables[reference]);
  return b ? std::clamp(x, b->low, b->high) : x;
}

unsigned input_from(Bytes& in) {
  unsigned inputs[variable_count], n = 0;
  for (unsigned r = 0; r < variable_count; ++r)
    if (variables[r].causality == Causality::Input) inputs[n++] = r;
  return inputs[in.below(n)];
}

unsigned reference_from(Bytes& in) {
  const unsigned wrong[] = {variable_count, 0x7fffffff, 0xffffffff};
  if (in.one_in(32)) return in.pick(wrong);
  return (in.byte() + 256u * in.below(2)) % variable_count;
}

}  // namespace

// As the model description has them, then what keeps calls short.
void Subject::set_starts() {
  expected_ = {};
  for (unsigned r = 0; r < variable_count; ++r) expected_.value[r] = variables[r].start;
  for (unsigned r = 0; r < variable_count; ++r)
    if (const CostBound* b = cost_bound(variables[r])) set_one(r, b->start);
}

void Subject::set_one(unsigned reference, double x) {
  const int integer = static_cast<int>(x);
  const bool real = variables[reference].type == Type::Real;
  begin_call();
  judge("set", real ? fmi2SetReal(component_, &reference, 1, &x) : fmi2SetInteger(component_, &reference, 1, &integer),
        Ok);
  expected_.value[reference] = x;
}

void Subject::get(Bytes& in) {
  const Type types[] = {Type::Real, Type::Real, Type::Integer, Type::Boolean};
  const Type type = in.pick(types);
  const std::size_t n = in.below(6);
  unsigned references[5];
  bool right = is_readable(expected_.state), calculated = false;
  for (std::size_t i = 0; i < n; ++i) {
    references[i] = reference_from(in);
    right = right && fuzz::exists(references[i], type);
    calculated = calculated || (right && !is_input_or_parameter(variables[references[i]]));
  }
  // Until the end of initialization there may be no model.
  const unsigned allowed = !right ? Refused : calculated && expected_.state == Initialization ? Ok | Refused : Ok;
  double reals[5];
  int integers[5];
  begin_call();
  fmi2Status status;
  if (type == Type::Real)
    status = fmi2GetReal(component_, n ? references : nullptr, n, n ? reals : nullptr);
  else
    status = (type == Type::Integer ? fmi2GetInteger : fmi2GetBoolean)(component_, n ? references : nullptr, n,
                                                                       n ? integers : nullptr);
  if (judge("get", status, allowed) != fmi2OK) return;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = type == Type::Real ? reals[i] : integers[i];
    if (!std::isfinite(x)) fault("fmi2GetReal", std::string("OK but not finite: ") + variables[references[i]].name);
    if (is_input_or_parameter(variables[references[i]]) && !expected_.foreign && x != expected_.value[references[i]])
      fault("get", std::string("not what was set: ") + variables[references[i]].name);
  }
}

void Subject::set(Bytes& in) {
  const Type types[] = {Type::Real, Type::Real, Type::Real, Type::Integer, Type::Boolean};
  const Type type = in.pick(types);
  const std::size_t n = in.below(6);
  unsigned references[5];
  double reals[5];
  int integers[5];
  bool right = is_settable(expected_.state);
  for (std::size_t i = 0; i < n; ++i) {
    references[i] = reference_from(in);
    reals[i] = affordable(references[i], in.number());
    integers[i] = static_cast<int>(affordable(references[i], in.one_in(8) ? -1.0 : in.below(6)));
    if (type != Type::Real) reals[i] = integers[i];
    right = right && may_set(references[i], type, expected_.state, reals[i]);
  }
  begin_call();
  fmi2Status status;
  if (type == Type::Real)
    status = fmi2SetReal(component_, n ? references : nullptr, n, n ? reals : nullptr);
  else
    status = (type == Type::Integer ? fmi2SetInteger : fmi2SetBoolean)(component_, n ? references : nullptr, n,
                                                                       n ? integers : nullptr);
  if (judge("set", status, right ? Ok : Refused) == fmi2OK)
    for (std::size_t i = 0; i < n; ++i) expected_.value[references[i]] = reals[i];
}

// A small change of an input, as a host makes before each step.
void Subject::set_input(Bytes& in) {
  if (!is_settable(expected_.state)) return;
  const unsigned r = input_from(in);
  const double scale[] = {1e-4, 1e-3, 0.1, 1};
  const double moved = variables[r].start + static_cast<std::int8_t>(in.byte()) * in.pick(scale);
  set_one(r, std::clamp(moved, variables[r].min, variables[r].max));
}

void Subject::set_input_derivatives(Bytes& in) {
  const std::size_t n = in.below(4);
  unsigned references[3];
  int orders[3];
  double values[3];
  bool right = is_settable(expected_.state);
  for (std::size_t i = 0; i < n; ++i) {
    references[i] = in.one_in(4) ? reference_from(in) : input_from(in);
    orders[i] = static_cast<int>(in.below(4));
    values[i] = in.number();
    right = right && may_set_input_derivative(references[i], orders[i], values[i]);
  }
  begin_call();
  judge(
      "fmi2SetRealInputDerivatives",
      fmi2SetRealInputDerivatives(component_, n ? references : nullptr, n, n ? orders : nullptr, n ? values : nullptr),
      right ? Ok : Refused);
}

void Subject::get_output_derivatives(Bytes& in) {
  const std::size_t n = in.below(4);
  unsigned references[3];
  int orders[3];
  double values[3] = {};
  bool right = has_stepped(expected_.state);
  for (std::size_t i = 0; i < n; ++i) {
    references[i] = reference_from(in);
    orders[i] = in.one_in(8) ? 2 : 1;
    right = right && may_get_output_derivative(references[i], orders[i]);
  }
  begin_call();
  // Refused where it overflows.
  const fmi2Status status = judge(
      "fmi2GetRealOutputDerivatives",
      fmi2GetRealOutputDerivatives(component_, n ? references : nullptr, n, n ? orders : nullptr, n ? values : nullptr),
      right ? Ok | Refused : Refused);
  if (status == fmi2OK && !std::all_of(values, values + 3, [](double x) { return std::isfinite(x); }))
    fault("fmi2GetRealOutputDerivatives", "OK but not finite");
}

void Subject::directional_derivative(Bytes& in) {
  const std::size_t n_unknown = in.below(4), n_known = in.below(3);
  unsigned unknown[3], known[2];
  double direction[2], change[3] = {};
  bool right = is_readable(expected_.state);
  for (std::size_t i = 0; i < n_unknown; ++i) right = may_be_unknown(unknown[i] = reference_from(in)) && right;
  for (std::size_t i = 0; i < n_known; ++i) {
    known[i] = in.one_in(4) ? reference_from(in) : input_from(in);
    right = may_be_known(known[i], direction[i] = in.number()) && right;
  }
  begin_call();
  const fmi2Status status = judge(
      "fmi2GetDirectionalDerivative",
      fmi2GetDirectionalDerivative(component_, n_unknown ? unknown : nullptr, n_unknown, n_known ? known : nullptr,
                                   n_known, n_known ? direction : nullptr, n_unknown ? change : nullptr),
      right ? Ok | Refused : Refused);
  if (status == fmi2OK && !std::all_of(change, change + 3, [](double x) { return std::isfinite(x); }))
    fault("fmi2GetDirectionalDerivative", "OK but not finite");
}

// Of Real, Integer, Boolean variables in the order of the model description.
std::vector<double> Subject::all_values() {
  std::vector<double> values(variable_count);
  begin_call();
  for (unsigned r = 0; r < variable_count; ++r) {
    int integer = 0;
    const Type type = asked_as(variables[r].type);
    const fmi2Status status = type == Type::Real      ? fmi2GetReal(component_, &r, 1, &values[r])
                              : type == Type::Integer ? fmi2GetInteger(component_, &r, 1, &integer)
                                                      : fmi2GetBoolean(component_, &r, 1, &integer);
    if (status != fmi2OK) fault("get", std::string("refused ") + variables[r].name);
    if (type != Type::Real) values[r] = integer;
  }
  return values;
}

void Subject::check_values() {
  const std::vector<double> values = all_values();
  for (unsigned r = 0; r < variable_count; ++r) {
    if (!std::isfinite(values[r])) fault("get", std::string("OK but not finite: ") + variables[r].name);
    if (!expected_.foreign && is_input_or_parameter(variables[r]) && values[r] != expected_.value[r])
      fault("get", std::string("not what was set: ") + variables[r].name);
  }
}

}  // namespace fuzz
