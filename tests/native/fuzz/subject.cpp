#include "subject.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace fuzz {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

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

// Header of a serialised state (fmi/serialization.cpp): magic, GUID, count, checksum.
constexpr std::size_t header_size = 64, count_at = 48, checksum_at = 56;

double number_at(const std::vector<char>& bytes, std::size_t i) {
  double x;
  std::memcpy(&x, bytes.data() + header_size + i * sizeof x, sizeof x);
  return x;
}

void repair(std::vector<char>& bytes) {
  const std::uint64_t count = (bytes.size() - header_size) / sizeof(double);
  std::memcpy(bytes.data() + count_at, &count, sizeof count);
  std::uint64_t hash = 14695981039346656037u;
  for (std::size_t i = header_size; i < bytes.size(); ++i)
    hash = (hash ^ static_cast<unsigned char>(bytes[i])) * 1099511628211u;
  std::memcpy(bytes.data() + checksum_at, &hash, sizeof hash);
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

void damage(std::vector<char>& bytes, Bytes& in) {
  if (bytes.size() < header_size + sizeof(double)) return;
  const std::size_t numbers = (bytes.size() - header_size) / sizeof(double);
  const std::size_t at = in.byte() + 256u * in.byte();
  switch (in.below(5)) {
    case 0:
      bytes[at % bytes.size()] = static_cast<char>(bytes[at % bytes.size()] ^ (1 << in.below(8)));
      break;
    case 1:
      bytes.resize(at % bytes.size());
      break;
    case 2:
      bytes.resize(bytes.size() + 1 + at % 100);
      break;
    case 3:
      bytes.resize(header_size + at % numbers * sizeof(double));
      if (bytes.size() > header_size) repair(bytes);
      break;
    default: {
      // Mostly the first numbers and the last: parameters, inputs, times; what the last step held.
      const std::size_t from_end[] = {at % numbers, at % std::min<std::size_t>(numbers, 100),
                                      numbers - 1 - at % std::min<std::size_t>(numbers, 100)};
      const double x = in.number();
      std::memcpy(bytes.data() + header_size + in.pick(from_end) * sizeof x, &x, sizeof x);
      repair(bytes);
    }
  }
}

void Subject::receive(fmi2ComponentEnvironment self, fmi2String, fmi2Status status, fmi2String category,
                      fmi2String text, ...) {
  auto& subject = *static_cast<Subject*>(self);
  const std::size_t n = std::strlen(text);
  if (n == 0 || text[n - 1] == '\n') subject.fault("logger", "an empty line, or one that ends with a line feed");
  bool declared = false;
#define FUZZ_CATEGORY(name) declared = declared || std::strcmp(category, #name) == 0;
  ZSPRING_LOG_CATEGORIES(FUZZ_CATEGORY)
#undef FUZZ_CATEGORY
  if (!declared) subject.fault("logger", std::string("category ") + category);
  subject.log_.lines += status >= fmi2Discard;
  subject.log_.status = std::max(subject.log_.status, status);
  subject.last_message_ = text;
}

void Subject::fault(const char* function, const std::string& what) const {
  std::fprintf(stderr, "FAULT %s: %s\n  state %d, t = %.17g s; last message: %s\n", function, what.c_str(),
               expected_.state, expected_.time, last_message_.c_str());
  std::abort();
}

std::vector<char> Subject::snapshot() {
  fmi2FMUstate state = nullptr;
  std::size_t size = 0;
  std::vector<char> bytes;
  bool ok = fmi2GetFMUstate(component_, &state) == fmi2OK &&
            fmi2SerializedFMUstateSize(component_, state, &size) == fmi2OK;
  bytes.resize(size);
  ok = ok && fmi2SerializeFMUstate(component_, state, bytes.data(), size) == fmi2OK &&
       fmi2FreeFMUstate(component_, &state) == fmi2OK;
  if (!ok || state) fault("snapshot", "failed");
  return bytes;
}

void Subject::begin_call() {
  before_ = snapshot();
  log_ = {};
  last_message_.clear();
}

fmi2Status Subject::judge(const char* function, fmi2Status status, unsigned allowed) {
  counts_.calls += 1;
  counts_.refused += status == fmi2Error;
  if (!(allowed >> status & 1)) fault(function, "returned status " + std::to_string(status));
  if (status == fmi2OK && log_.lines > 0) fault(function, "is OK but logged a failure");
  if (status != fmi2OK && (log_.lines != 1 || log_.status != status))
    fault(function, "failed without one line that tells why");
  // In Initialization Mode the model is built when it is first asked for.
  if (status != fmi2OK && expected_.state >= StepComplete) {
    std::vector<char> after = snapshot();
    // A discarded step is told in the first number.
    const std::size_t begin = header_size + (status == fmi2Discard ? sizeof(double) : 0);
    if (before_.size() != after.size() || std::memcmp(&before_[begin], &after[begin], after.size() - begin) != 0)
      fault(function, "failed and changed the state");
  }
  return status;
}

void Subject::instantiate(Bytes& in) {
  if (component_) return;
  callbacks_ = {receive, nullptr, nullptr, nullptr, this};
  const bool wrong_guid = in.one_in(16), wrong_type = in.one_in(16), no_name = in.one_in(16);
  log_ = {};
  component_ = fmi2Instantiate(no_name ? "" : "subject %s", wrong_type ? fmi2ModelExchange : fmi2CoSimulation,
                               wrong_guid ? "{0}" : ZSPRING_GUID, in.one_in(2) ? nullptr : "file:///nowhere",
                               &callbacks_, fmi2False, in.one_in(2));
  counts_.calls += 1;
  const bool wrong = wrong_guid || wrong_type || no_name;
  if ((component_ != nullptr) == wrong) fault("fmi2Instantiate", "wrong arguments taken or right ones refused");
  if (wrong && log_.lines != 1) fault("fmi2Instantiate", "refused without one line that tells why");
  if (component_) set_starts();
}

void Subject::free() {
  fmi2FreeInstance(component_);
  component_ = nullptr;
}

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
  judge("set",
        real ? fmi2SetReal(component_, &reference, 1, &x) : fmi2SetInteger(component_, &reference, 1, &integer),
        Ok);
  expected_.value[reference] = x;
}

void Subject::setup(Bytes& in) {
  const double start = in.number(), stop = in.one_in(2) ? start + in.finite_number() : in.number();
  const bool has_stop = in.one_in(3);
  const bool right = expected_.state == Instantiated && std::isfinite(start) && (!has_stop || stop >= start);
  begin_call();
  if (judge("fmi2SetupExperiment",
            fmi2SetupExperiment(component_, in.one_in(2), in.number(), start, has_stop, stop),
            right ? Ok : Refused) == fmi2OK) {
    expected_.time = start;
    expected_.stop = stop;
    expected_.has_stop = has_stop;
  }
}

void Subject::enter_initialization() {
  begin_call();
  if (judge("fmi2EnterInitializationMode", fmi2EnterInitializationMode(component_),
            expected_.state == Instantiated ? Ok : Refused) == fmi2OK)
    expected_.state = Initialization;
}

void Subject::exit_initialization() {
  begin_call();
  // Parameters that make no model are refused here.
  if (judge("fmi2ExitInitializationMode", fmi2ExitInitializationMode(component_),
            expected_.state == Initialization ? Ok | Refused : Refused) == fmi2OK) {
    expected_.state = StepComplete;
    if (expected_.foreign) adopt_time();
    check_values();
  }
}

void Subject::terminate() {
  begin_call();
  if (judge("fmi2Terminate", fmi2Terminate(component_), is_stepping(expected_.state) ? Ok : Refused) == fmi2OK)
    expected_.state = Terminated;
}

void Subject::reset() {
  begin_call();
  judge("fmi2Reset", fmi2Reset(component_), Ok);
  set_starts();
}

void Subject::start() {
  reset();
  begin_call();
  judge("fmi2SetupExperiment", fmi2SetupExperiment(component_, fmi2False, 0, 0, fmi2False, 0), Ok);
  enter_initialization();
  exit_initialization();
  if (expected_.state != StepComplete) fault("fmi2ExitInitializationMode", "refused the start values");
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
    if (!std::isfinite(x))
      fault("fmi2GetReal", std::string("OK but not finite: ") + variables[references[i]].name);
    if (is_input_or_parameter(variables[references[i]]) && !expected_.foreign &&
        x != expected_.value[references[i]])
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
  set_one(r, variables[r].start + static_cast<std::int8_t>(in.byte()) * in.pick(scale));
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
  judge("fmi2SetRealInputDerivatives",
        fmi2SetRealInputDerivatives(component_, n ? references : nullptr, n, n ? orders : nullptr,
                                    n ? values : nullptr),
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
  const fmi2Status status = judge("fmi2GetRealOutputDerivatives",
                                  fmi2GetRealOutputDerivatives(component_, n ? references : nullptr, n,
                                                               n ? orders : nullptr, n ? values : nullptr),
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

void Subject::step(Bytes& in) {
  const double usual[] = {1e-3, 2e-3, 1e-5, 0.02, 0.1, 0.0123, 1e-7, 0.5};
  const double unusual[] = {0, -1e-3, nan, HUGE_VAL, -HUGE_VAL, 1e-15, 1e-300, 1e300, 1e17};
  const double length = in.one_in(8) ? in.pick(unusual) : in.pick(usual);
  const double times[] = {expected_.time, expected_.time + 0.5 * length, expected_.time - 1, nan,
                          HUGE_VAL,       expected_.time * (1 + 1e-15)};
  step_to(in.one_in(8) ? in.pick(times) : expected_.time, length);
}

// Whether the step was made.
bool Subject::step_to(double from, double length) {
  const double off = std::abs(from - expected_.time), past = from + length - expected_.stop;
  unsigned allowed = Ok | Discarded;
  if (!is_stepping(expected_.state) || !(length > 0) || !std::isfinite(length) ||
      !(off <= 1e-3 * length + 1e-11 * std::abs(expected_.time)) ||
      (expected_.has_stop && past > 0.01 * length + 1e-9 * std::abs(expected_.time)))
    allowed = Refused;
  else if (off > 1e-5 * length || (expected_.has_stop && past > 0) || expected_.foreign)
    allowed |= Refused;
  begin_call();
  const fmi2Status status = judge("fmi2DoStep", fmi2DoStep(component_, from, length, fmi2False), allowed);
  if (status == fmi2Discard) {
    expected_.state = StepFailed;
    counts_.discarded += 1;
  } else if (status == fmi2OK) {
    expected_.state = StepComplete;
    expected_.time = from + length;
    counts_.steps += 1;
    check_values();
  }
  if (status != fmi2Error) {
    double last;
    begin_call();
    judge("fmi2GetRealStatus", fmi2GetRealStatus(component_, fmi2LastSuccessfulTime, &last), Ok);
    if (last != expected_.time) fault("fmi2GetRealStatus", "wrong time");
  }
  return status == fmi2OK;
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

// Calls with pending steps, with strings, without pointers, without an instance.
void Subject::never_allowed(Bytes& in) {
  unsigned r = 0;
  double x = 0;
  int i = 0;
  fmi2Status s;
  fmi2String text = nullptr;
  const unsigned never = Refused, asynchronous = has_stepped(expected_.state) ? Discarded : Refused;
  begin_call();
  switch (in.below(14)) {
    case 0:
      judge("fmi2CancelStep", fmi2CancelStep(component_), never);
      break;
    case 1:
      judge("fmi2GetStatus", fmi2GetStatus(component_, fmi2DoStepStatus, &s), asynchronous);
      break;
    case 2:
      judge("fmi2GetIntegerStatus", fmi2GetIntegerStatus(component_, fmi2PendingStatus, &i), asynchronous);
      break;
    case 3:
      judge("fmi2GetStringStatus", fmi2GetStringStatus(component_, fmi2PendingStatus, &text), asynchronous);
      break;
    case 4:
      judge("fmi2GetRealStatus", fmi2GetRealStatus(component_, fmi2DoStepStatus, &x), asynchronous);
      break;
    case 5:
      judge("fmi2GetString", fmi2GetString(component_, &r, 1, &text), never);
      break;
    case 6:
      judge("fmi2SetString", fmi2SetString(component_, &r, 1, &text), never);
      break;
    case 7:
      judge("fmi2GetReal", fmi2GetReal(component_, nullptr, 1, &x), never);
      break;
    case 8:
      judge("fmi2SetReal", fmi2SetReal(component_, &r, 1, nullptr), never);
      break;
    case 9:
      judge("fmi2GetFMUstate", fmi2GetFMUstate(component_, nullptr), never);
      break;
    case 10:
      judge("fmi2SetFMUstate", fmi2SetFMUstate(component_, nullptr), never);
      break;
    case 11:
      judge("fmi2DeSerializeFMUstate", fmi2DeSerializeFMUstate(component_, nullptr, 64, nullptr), never);
      break;
    case 12:
      judge("fmi2SetRealInputDerivatives", fmi2SetRealInputDerivatives(component_, &r, 1, nullptr, &x), never);
      break;
    default:
      if (fmi2DoStep(nullptr, 0, 1, 0) != fmi2Error || fmi2Reset(nullptr) != fmi2Error ||
          fmi2GetReal(nullptr, &r, 1, &x) != fmi2Error || fmi2Terminate(nullptr) != fmi2Error)
        fault("any call", "took no instance for one");
      fmi2FreeInstance(nullptr);
  }
}

void Subject::set_debug_logging(Bytes& in) {
  const fmi2String names[] = {"logAll",   "logSolver", "logStatusError", "logStatusWarning",
                              "nonsense", "",          nullptr};
  fmi2String chosen[3];
  const std::size_t n = in.below(4);
  bool right = true;
  for (std::size_t i = 0; i < n; ++i) {
    const unsigned k = in.below(7);
    chosen[i] = names[k];
    right = right && k < 4;
  }
  begin_call();
  judge("fmi2SetDebugLogging", fmi2SetDebugLogging(component_, in.one_in(2), n, n ? chosen : nullptr),
        right ? Ok : Refused);
}

void Subject::keep(KeptState& kept) {
  begin_call();
  judge("fmi2GetFMUstate", fmi2GetFMUstate(component_, &kept.state), Ok);
  kept.expected = expected_;
  counts_.states += 1;
}

void Subject::go_back(const KeptState& kept) {
  if (!kept.state) return;
  begin_call();
  judge("fmi2SetFMUstate", fmi2SetFMUstate(component_, kept.state), Ok);
  expected_ = kept.expected;
  if (expected_.foreign) adopt();
  if (has_stepped(expected_.state)) check_values();
}

// From a state of damaged bytes: what can be learnt from it.
void Subject::adopt() {
  const double phase = number_at(snapshot(), 0);
  expected_.state = static_cast<State>(std::lround(std::log2(phase)));
  if (!(phase >= 1 && phase <= 32) || std::ldexp(1, expected_.state) != phase)
    fault("fmi2SetFMUstate", "no state of an FMU");
  expected_.has_stop = false;
  if (has_stepped(expected_.state)) adopt_time();
}

void Subject::adopt_time() {
  begin_call();
  judge("fmi2GetRealStatus", fmi2GetRealStatus(component_, fmi2LastSuccessfulTime, &expected_.time), Ok);
}

void Subject::forget(KeptState& kept) {
  begin_call();
  judge("fmi2FreeFMUstate", fmi2FreeFMUstate(component_, &kept.state), Ok);
  if (kept.state) fault("fmi2FreeFMUstate", "left the pointer");
}

std::vector<char> Subject::serialize(const KeptState& kept) {
  std::size_t size = 0;
  begin_call();
  judge("fmi2SerializedFMUstateSize", fmi2SerializedFMUstateSize(component_, kept.state, &size),
        kept.state ? Ok : Refused);
  std::vector<char> bytes(size);
  if (!kept.state) return bytes;
  begin_call();
  judge("fmi2SerializeFMUstate", fmi2SerializeFMUstate(component_, kept.state, bytes.data(), size - 1), Refused);
  begin_call();
  judge("fmi2SerializeFMUstate", fmi2SerializeFMUstate(component_, kept.state, bytes.data(), size), Ok);
  return bytes;
}

void Subject::deserialize(const std::vector<char>& bytes, KeptState& kept, const Expected* original) {
  begin_call();
  if (judge("fmi2DeSerializeFMUstate",
            fmi2DeSerializeFMUstate(component_, bytes.data(), bytes.size(), &kept.state),
            bytes.empty() ? Refused
            : original    ? Ok
                          : Ok | Refused) != fmi2OK)
    return;
  kept.expected = original ? *original : Expected{};
  if (!original) {
    kept.expected.foreign = true;
    counts_.foreign_states += 1;
  }
}

void Subject::replay(Bytes& in) {
  if (!is_stepping(expected_.state)) return;
  const Bytes script = in;
  const unsigned n = 1 + in.below(4);
  const double lengths[] = {1e-3, 2e-3, 0.01, 3e-4};
  const auto run = [&](Bytes choices) {
    std::vector<double> record = all_values();
    choices.below(4);
    for (unsigned i = 0; i < n; ++i) {
      set_input(choices);
      record.push_back(step_to(expected_.time, choices.pick(lengths)));
      const std::vector<double> values = all_values();
      record.insert(record.end(), values.begin(), values.end());
    }
    return record;
  };
  const auto compare = [&](const char* function, const std::vector<double>& a, const std::vector<double>& b) {
    const std::size_t row = variable_count + 1;  // after each step whether it was made, then all values
    for (std::size_t k = 0; k < a.size(); ++k) {
      if (std::memcmp(&a[k], &b[k], sizeof a[k]) == 0) continue;
      const std::size_t column = (k + 1) % row;
      char text[200];
      std::snprintf(text, sizeof text, "after %zu steps from it, %s = %.17g, once it was %.17g", (k + 1) / row,
                    column ? variables[column - 1].name : "step made", b[k], a[k]);
      fault(function, text);
    }
  };
  KeptState kept, again;
  keep(kept);
  const std::vector<double> first = run(script);
  go_back(kept);
  compare("fmi2SetFMUstate", first, run(script));
  deserialize(serialize(kept), again, &kept.expected);
  go_back(again);
  compare("fmi2DeSerializeFMUstate", first, run(script));
  forget(kept);
  forget(again);
  for (unsigned used = 0; used < 1 + 4 * n && !in.done(); ++used) in.byte();
  counts_.replays += 1;
}

}  // namespace fuzz
