// The life of an instance, its steps, and how calls are judged.
#include "subject.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace fuzz {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

}  // namespace

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
  bool ok =
      fmi2GetFMUstate(component_, &state) == fmi2OK && fmi2SerializedFMUstateSize(component_, state, &size) == fmi2OK;
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
  counts_.situations.emplace(function, expected_.state);
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

void Subject::setup(Bytes& in) {
  const double start = in.number(), stop = in.one_in(2) ? start + in.finite_number() : in.number();
  const bool has_stop = in.one_in(3);
  const bool right = expected_.state == Instantiated && std::isfinite(start) && (!has_stop || stop >= start);
  begin_call();
  if (judge("fmi2SetupExperiment", fmi2SetupExperiment(component_, in.one_in(2), in.number(), start, has_stop, stop),
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
  const fmi2String names[] = {"logAll", "logSolver", "logStatusError", "logStatusWarning", "nonsense", "", nullptr};
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

}  // namespace fuzz
