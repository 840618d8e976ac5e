// The states of an FMU and the calls that are allowed in each: sections 4.2.3 and 4.2.4 of the standard.
#pragma once

namespace zspring::fmi {

// As bits, so that a call can name those in which it is allowed.
enum Phase : unsigned {
  Instantiated = 1,
  Initialization = 2,
  StepComplete = 4,
  StepFailed = 8,  // after fmi2Discard; the state is that before the step, so stepping on is possible
  Terminated = 16,
  Error = 32,
};

inline constexpr unsigned any_phase = Instantiated | Initialization | StepComplete | StepFailed | Terminated | Error;
inline constexpr unsigned before_start = Instantiated | Initialization;
inline constexpr unsigned stepping = StepComplete | StepFailed;
inline constexpr unsigned settable = before_start | stepping;
inline constexpr unsigned readable = any_phase & ~Instantiated;
inline constexpr unsigned after_step = stepping | Terminated | Error;

inline const char* phase_name(Phase phase) {
  constexpr struct {
    Phase phase;
    const char* name;
  } names[] = {{Instantiated, "before fmi2EnterInitializationMode"},
               {Initialization, "in Initialization Mode"},
               {StepComplete, "between steps"},
               {StepFailed, "after a discarded step"},
               {Terminated, "after fmi2Terminate"}};
  for (const auto& n : names)
    if (n.phase == phase) return n.name;
  return "after an internal error";
}

}  // namespace zspring::fmi
