// An instance's state as numbers, and back.
#include <cmath>

#include "instance.hpp"

namespace zspring::fmi {
namespace {

Phase phase_of(double number) {
  for (Phase p : {Instantiated, Initialization, StepComplete, StepFailed, Terminated, Error})
    if (number == p) return p;
  refuse("FMU state: %g is no state of an FMU", number);
}

// The table's checksum as two numbers that doubles hold; 0 without one.
double half_of_checksum(const Origin& origin, int half) {
  return static_cast<double>(origin.table.value_or(0) >> 32 * half & 0xffffffffu);
}

}  // namespace

// Returns whether the parameters that make the model are those from before.
template <class Visitor>
bool Instance::visit_values(Visitor&& f) {
  bool same_model = true;
  for (const Variable& v : variables) {
    if (!v.is_parameter()) continue;
    const double before = v.get(parameters_);
    double x = before;
    f(x);
    check_value(v, x);
    v.set(parameters_, x);
    same_model = same_model && (v.tunable || x == before);
  }
  visit(inputs_, f);
  f(stop_), f(time_), f(stepped_);
  return same_model;
}

Numbers Instance::snapshot() {
  Numbers numbers{static_cast<double>(phase), half_of_checksum(origin_, 0), half_of_checksum(origin_, 1)};
  Writer write{numbers};
  visit_values(write);
  // A simulation that parameters or inputs have outdated is not part of the state.
  write(simulation_.has_value());
  if (simulation_) simulation_->write(write);
  return numbers;
}

void Instance::restore(const Numbers& numbers) {
  Reader read{numbers.data(), numbers.data() + numbers.size()};
  double stored_phase, of_table[2];
  read(stored_phase), read(of_table[0]), read(of_table[1]);
  if (of_table[0] != half_of_checksum(origin_, 0) || of_table[1] != half_of_checksum(origin_, 1))
    refuse("FMU state: is that of an FMU with another %s.table, or none", Table::name);
  phase = phase_of(stored_phase);
  const bool same_model = visit_values(read);
  bool has_simulation;
  read(has_simulation);
  forget_discard();
  // Hosts that iterate restore at every step: a model of the same parameters is kept, only its state is replaced.
  if (!has_simulation || !same_model) simulation_.reset();
  if (has_simulation) simulation().restore(read);
  if (read.in != read.end) refuse("FMU state: goes on after its last value");
}

void Instance::check_state(const Numbers& numbers) const {
  for (double x : numbers)
    if (!std::isfinite(x)) refuse("FMU state: holds a value that is not finite");
  Instance trial({}, "", false);
  trial.origin_ = origin_, trial.table_ = table_;
  trial.restore(numbers);
  if (!trial.simulation_ && trial.phase & (StepComplete | StepFailed | Terminated))
    refuse("FMU state: lacks its simulation");
}

}  // namespace zspring::fmi
