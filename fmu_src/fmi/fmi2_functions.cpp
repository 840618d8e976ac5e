// The C API of FMI 2.0 for co-simulation: each function checks what the standard asks for, calls the instance and
// maps what was thrown to a status. No exception crosses this boundary and there is no global state.
#include <cstring>
#include <functional>
#include <memory>
#include <type_traits>

#include "fmi2Functions.h"
#include "instance.hpp"
#include "serialization.hpp"

using namespace zspring;
using namespace zspring::fmi;

namespace {

// `action`, of an instance and the arguments, does what the call is for; where it returns no status, it is fmi2OK.
template <class Action, class... Arguments>
fmi2Status guarded(fmi2Component component, unsigned allowed, const char* function, Action&& action,
                   Arguments... arguments) {
  auto* instance = static_cast<Instance*>(component);
  if (!instance) return fmi2Error;
  const auto fail = [&](const char* reason) {
    instance->log.write(fmi2Error, Category::logStatusError, text("%s: %s", function, reason));
    return fmi2Error;
  };
  if (!(instance->phase & allowed)) return fail(text("not allowed %s", phase_name(instance->phase)).chars);
  try {
    if constexpr (std::is_void_v<std::invoke_result_t<Action, Instance&, Arguments...>>)
      return std::invoke(action, *instance, arguments...), fmi2OK;
    else
      return std::invoke(action, *instance, arguments...);
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
    for (size_t k = 0; k < n; ++k) i.check_settable(vr[k], type, values[k]);  // all or nothing
    for (size_t k = 0; k < n; ++k) i.set(vr[k], values[k]);
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
  return guarded(c, any_phase, __func__, [&](Instance& i) {
    if (const char* unknown = i.log.enable(on != fmi2False, n, categories))
      refuse("category %s: is not a log category of this FMU", unknown);
  });
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions* functions, fmi2Boolean /*visible*/, fmi2Boolean debug) {
  if (!functions) return nullptr;
  try {
    const bool named = name && *name;
    auto instance = std::make_unique<Instance>(*functions, named ? name : "(unnamed)", debug != fmi2False);
    const auto fail = [&](const Text& reason) {
      instance->log.write(fmi2Error, Category::logStatusError, reason);
      return nullptr;
    };
    try {
      instance->begin_as(Origin::of(guid), resources);
    } catch (const Refusal& e) {
      return fail(text("%s", e.what()));
    }
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
  return guarded(c, Instantiated, __func__, &Instance::setup_experiment, start, has_stop != fmi2False, stop);
}
fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
  return guarded(c, Instantiated, __func__, &Instance::enter_initialization);
}
fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
  return guarded(c, Initialization, __func__, &Instance::exit_initialization);
}
fmi2Status fmi2Terminate(fmi2Component c) { return guarded(c, stepping, __func__, &Instance::terminate); }
fmi2Status fmi2Reset(fmi2Component c) { return guarded(c, any_phase, __func__, &Instance::reset); }

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[]) {
  return get_values(c, __func__, Type::Real, vr, n, value);
}
fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Integer value[]) {
  return get_values(c, __func__, Type::Integer, vr, n, value);
}
fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Boolean value[]) {
  return get_values(c, __func__, Type::Boolean, vr, n, value);
}
fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference[], size_t n, fmi2String[]) {
  return no_strings(c, readable, __func__, n);
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[]) {
  return set_values(c, __func__, Type::Real, vr, n, value);
}
fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Integer value[]) {
  return set_values(c, __func__, Type::Integer, vr, n, value);
}
fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Boolean value[]) {
  return set_values(c, __func__, Type::Boolean, vr, n, value);
}
fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference[], size_t n, const fmi2String[]) {
  return no_strings(c, settable, __func__, n);
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate* state) {
  return guarded(c, any_phase, __func__, [&](Instance& i) {
    need(state, 1, "FMUstate");
    *state = i.states.keep(i.snapshot(), *state);
  });
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
  return guarded(c, any_phase, __func__, [&](Instance& i) { i.restore(i.states.of(state)); });
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate* state) {
  return guarded(c, any_phase, __func__, [&](Instance& i) {
    if (!state || !*state) return;
    i.states.forget(*state);
    *state = nullptr;
  });
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t* size) {
  return guarded(c, any_phase, __func__, [&](Instance& i) {
    need(size, 1, "size");
    *size = serialized_size(i.states.of(state));
  });
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
  return guarded(c, any_phase, __func__, [&](Instance& i) {
    need(bytes, 1, "serializedState");
    const Numbers& numbers = i.states.of(state);
    if (size < serialized_size(numbers)) refuse("size: is less than fmi2SerializedFMUstateSize told");
    serialize(numbers, bytes);
  });
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate* state) {
  return guarded(c, any_phase, __func__, [&](Instance& i) {
    need(bytes, 1, "serializedState"), need(state, 1, "FMUstate");
    Numbers numbers = deserialize(bytes, size);
    i.check_state(numbers);
    *state = i.states.keep(std::move(numbers), *state);
  });
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t n_unknown,
                                        const fmi2ValueReference known[], size_t n_known, const fmi2Real known_change[],
                                        fmi2Real unknown_change[]) {
  return guarded(c, readable, __func__, [&](Instance& i) {
    need(unknown, n_unknown, "vUnknown_ref"), need(known, n_known, "vKnown_ref");
    need(known_change, n_known, "dvKnown"), need(unknown_change, n_unknown, "dvUnknown");
    i.directional_derivative(unknown, n_unknown, known, n_known, known_change, unknown_change);
  });
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                       const fmi2Integer order[], const fmi2Real value[]) {
  return guarded(c, settable, __func__, [&](Instance& i) {
    need(vr, n, "vr"), need(order, n, "order"), need(value, n, "value");
    i.set_input_derivatives(vr, n, order, value);
  });
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                        const fmi2Integer order[], fmi2Real value[]) {
  return guarded(c, after_step, __func__, [&](Instance& i) {
    need(vr, n, "vr"), need(order, n, "order"), need(value, n, "value");
    i.output_derivatives(vr, n, order, value);
  });
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real from, fmi2Real length, fmi2Boolean /*no_set_state_prior*/) {
  return guarded(c, stepping, __func__, &Instance::step, from, length);
}
fmi2Status fmi2CancelStep(fmi2Component c) {
  return guarded(c, 0, __func__, [](Instance&) {});
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real* value) {
  if (kind != fmi2LastSuccessfulTime) return no_status(c, __func__);
  return guarded(c, after_step, __func__, [&](Instance& i) {
    need(value, 1, "value");
    *value = i.last_successful_time();
  });
}
fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean* value) {
  if (kind != fmi2Terminated) return no_status(c, __func__);
  return guarded(c, after_step, __func__, [&](Instance& i) {
    need(value, 1, "value");
    *value = i.wants_to_end();
  });
}
fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind, fmi2Status*) { return no_status(c, __func__); }
fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind, fmi2Integer*) { return no_status(c, __func__); }
fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind, fmi2String*) { return no_status(c, __func__); }

}  // extern "C"
