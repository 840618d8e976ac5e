// The C API of FMI 2.0 for co-simulation: each function checks what the standard asks for, calls the instance and
// maps what was thrown to a status. No exception crosses this boundary and there is no global state.
#include <cstring>
#include <memory>
#include <type_traits>

#include "fmi2Functions.h"
#include "instance.hpp"
#include "serialization.hpp"

using namespace zspring;
using namespace zspring::fmi;

namespace {

using State = zspring::Numbers;

// `action` does what the call is for; where it returns no status, it is fmi2OK.
template <class Action>
fmi2Status guarded(fmi2Component component, unsigned allowed, const char* function, Action&& action) {
  auto* instance = static_cast<Instance*>(component);
  if (!instance) return fmi2Error;
  const auto fail = [&](const char* reason) {
    instance->log.write(fmi2Error, Category::logStatusError, text("%s: %s", function, reason));
    return fmi2Error;
  };
  if (!(instance->phase & allowed)) return fail(text("not allowed %s", phase_name(instance->phase)).chars);
  try {
    if constexpr (std::is_void_v<decltype(action(*instance))>)
      return action(*instance), fmi2OK;
    else
      return action(*instance);
  } catch (const Refusal& e) {
    return fail(e.what());
  } catch (const std::exception& e) {
    instance->phase = Error;
    return fail(e.what());
  } catch (...) {
    instance->phase = Error;
    return fail("unknown failure");
  }
}

void need(const void* pointer, size_t n, const char* name) {
  if (n > 0 && !pointer) refuse("%s: must not be NULL", name);
}

template <class Value>
fmi2Status get_values(fmi2Component c, const char* function, Type type, const fmi2ValueReference vr[], size_t n,
                      Value values[]) {
  return guarded(c, readable, function, [&](Instance& i) {
    need(vr, n, "vr"), need(values, n, "value");
    for (size_t k = 0; k < n; ++k) values[k] = static_cast<Value>(i.get(vr[k], type));
  });
}

template <class Value>
fmi2Status set_values(fmi2Component c, const char* function, Type type, const fmi2ValueReference vr[], size_t n,
                      const Value values[]) {
  return guarded(c, settable, function, [&](Instance& i) {
    need(vr, n, "vr"), need(values, n, "value");
    // On the stack for the usual few, so that setting inputs between steps does not allocate.
    double few[32];
    std::vector<double> many(n > 32 ? n : 0);
    double* numbers = n > 32 ? many.data() : few;
    for (size_t k = 0; k < n; ++k) numbers[k] = static_cast<double>(values[k]);
    i.set(vr, n, type, numbers);
  });
}

fmi2Status no_strings(fmi2Component c, unsigned allowed, const char* function, size_t n) {
  return guarded(c, allowed, function, [&](Instance&) {
    if (n > 0) refuse("this FMU has no variables of type String");
  });
}

// Only asynchronous steps have a pending status; these never run.
fmi2Status no_status(fmi2Component c, const char* function) {
  return guarded(c, after_step, function, [&](Instance& i) {
    i.log.write(fmi2Discard, Category::logStatusDiscard,
                text("this status is not available: steps are never asynchronous"));
    return fmi2Discard;
  });
}

}  // namespace

extern "C" {

const char* fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char* fmi2GetVersion(void) { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[]) {
  return guarded(c, any_phase, "fmi2SetDebugLogging", [&](Instance& i) {
    if (const char* unknown = i.log.enable(on != fmi2False, n, categories))
      refuse("category %s: is not a log category of this FMU", unknown);
  });
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String /*resources*/,
                              const fmi2CallbackFunctions* functions, fmi2Boolean /*visible*/, fmi2Boolean debug) {
  if (!functions) return nullptr;
  try {
    const bool named = name && *name;
    auto instance = std::make_unique<Instance>(*functions, named ? name : "(unnamed)", debug != fmi2False);
    const auto fail = [&](const Text& reason) {
      instance->log.write(fmi2Error, Category::logStatusError, reason);
      return nullptr;
    };
    if (!guid || std::strcmp(guid, ZSPRING_GUID) != 0)
      return fail(text("fmuGUID = %s: must be " ZSPRING_GUID
                       "; modelDescription.xml and library are not from the same FMU",
                       guid ? guid : "NULL"));
    if (type != fmi2CoSimulation) return fail(text("fmuType: this FMU is for co-simulation only"));
    if (!named) return fail(text("instanceName: must not be empty"));
    return instance.release();
  } catch (...) {
  }
  return nullptr;
}

void fmi2FreeInstance(fmi2Component c) { delete static_cast<Instance*>(c); }

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean /*tolerance_defined*/, fmi2Real /*tolerance*/,
                               fmi2Real start, fmi2Boolean has_stop, fmi2Real stop) {
  return guarded(c, Instantiated, "fmi2SetupExperiment",
                 [&](Instance& i) { i.setup_experiment(start, has_stop != fmi2False, stop); });
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
  return guarded(c, Instantiated, "fmi2EnterInitializationMode", [](Instance& i) { i.enter_initialization(); });
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
  return guarded(c, Initialization, "fmi2ExitInitializationMode", [](Instance& i) { i.exit_initialization(); });
}

fmi2Status fmi2Terminate(fmi2Component c) {
  return guarded(c, stepping, "fmi2Terminate", [](Instance& i) { i.terminate(); });
}

fmi2Status fmi2Reset(fmi2Component c) {
  return guarded(c, any_phase, "fmi2Reset", [](Instance& i) { i.reset(); });
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[]) {
  return get_values(c, "fmi2GetReal", Type::Real, vr, n, value);
}
fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Integer value[]) {
  return get_values(c, "fmi2GetInteger", Type::Integer, vr, n, value);
}
fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Boolean value[]) {
  return get_values(c, "fmi2GetBoolean", Type::Boolean, vr, n, value);
}
fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference[], size_t n, fmi2String[]) {
  return no_strings(c, readable, "fmi2GetString", n);
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[]) {
  return set_values(c, "fmi2SetReal", Type::Real, vr, n, value);
}
fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Integer value[]) {
  return set_values(c, "fmi2SetInteger", Type::Integer, vr, n, value);
}
fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Boolean value[]) {
  return set_values(c, "fmi2SetBoolean", Type::Boolean, vr, n, value);
}
fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference[], size_t n, const fmi2String[]) {
  return no_strings(c, settable, "fmi2SetString", n);
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate* state) {
  return guarded(c, any_phase, "fmi2GetFMUstate", [&](Instance& i) {
    need(state, 1, "FMUstate");
    if (*state)
      *static_cast<State*>(*state) = i.snapshot();
    else
      *state = new State(i.snapshot());
  });
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
  return guarded(c, any_phase, "fmi2SetFMUstate", [&](Instance& i) {
    need(state, 1, "FMUstate");
    i.restore(*static_cast<State*>(state));
  });
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate* state) {
  return guarded(c, any_phase, "fmi2FreeFMUstate", [&](Instance&) {
    if (!state) return;
    delete static_cast<State*>(*state);
    *state = nullptr;
  });
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t* size) {
  return guarded(c, any_phase, "fmi2SerializedFMUstateSize", [&](Instance&) {
    need(state, 1, "FMUstate"), need(size, 1, "size");
    *size = serialized_size(*static_cast<State*>(state));
  });
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
  return guarded(c, any_phase, "fmi2SerializeFMUstate", [&](Instance&) {
    need(state, 1, "FMUstate"), need(bytes, 1, "serializedState");
    const State& numbers = *static_cast<State*>(state);
    if (size < serialized_size(numbers)) refuse("size: is less than fmi2SerializedFMUstateSize told");
    serialize(numbers, bytes);
  });
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate* state) {
  return guarded(c, any_phase, "fmi2DeSerializeFMUstate", [&](Instance&) {
    need(bytes, 1, "serializedState"), need(state, 1, "FMUstate");
    State numbers = deserialize(bytes, size);
    Instance::check_state(numbers);
    if (*state)
      *static_cast<State*>(*state) = std::move(numbers);
    else
      *state = new State(std::move(numbers));
  });
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t n_unknown,
                                        const fmi2ValueReference known[], size_t n_known, const fmi2Real known_change[],
                                        fmi2Real unknown_change[]) {
  return guarded(c, readable, "fmi2GetDirectionalDerivative", [&](Instance& i) {
    need(unknown, n_unknown, "vUnknown_ref"), need(known, n_known, "vKnown_ref");
    need(known_change, n_known, "dvKnown"), need(unknown_change, n_unknown, "dvUnknown");
    i.directional_derivative(unknown, n_unknown, known, n_known, known_change, unknown_change);
  });
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                       const fmi2Integer order[], const fmi2Real value[]) {
  return guarded(c, settable, "fmi2SetRealInputDerivatives", [&](Instance& i) {
    need(vr, n, "vr"), need(order, n, "order"), need(value, n, "value");
    i.set_input_derivatives(vr, n, order, value);
  });
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                        const fmi2Integer order[], fmi2Real value[]) {
  return guarded(c, after_step, "fmi2GetRealOutputDerivatives", [&](Instance& i) {
    need(vr, n, "vr"), need(order, n, "order"), need(value, n, "value");
    i.output_derivatives(vr, n, order, value);
  });
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real from, fmi2Real length, fmi2Boolean /*no_set_state_prior*/) {
  return guarded(c, stepping, "fmi2DoStep", [&](Instance& i) { return i.step(from, length); });
}

fmi2Status fmi2CancelStep(fmi2Component c) {
  return guarded(c, 0, "fmi2CancelStep", [](Instance&) {});
}

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind, fmi2Status*) { return no_status(c, "fmi2GetStatus"); }

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real* value) {
  if (kind != fmi2LastSuccessfulTime) return no_status(c, "fmi2GetRealStatus");
  return guarded(c, after_step, "fmi2GetRealStatus", [&](Instance& i) {
    need(value, 1, "value");
    *value = i.last_successful_time();
  });
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind, fmi2Integer*) {
  return no_status(c, "fmi2GetIntegerStatus");
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean* value) {
  if (kind != fmi2Terminated) return no_status(c, "fmi2GetBooleanStatus");
  return guarded(c, after_step, "fmi2GetBooleanStatus", [&](Instance& i) {
    need(value, 1, "value");
    *value = i.wants_to_end();
  });
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind, fmi2String*) {
  return no_status(c, "fmi2GetStringStatus");
}

}  // extern "C"
