#include "simulation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include "communication_step.hpp"

namespace zspring::catenary {
namespace {

[[noreturn]] void refuse_start(const Parameters& p, int i, const Passage& at, double length) {
  char text[200];
  const char* name = p.travel == Travel::Speed ? "start" : "position";
  std::snprintf(
      text, sizeof text,
      "pantograph[%d].%s = %.10g m: must be within the line, 0 to %.10g m, as pantograph[%d].force = %.10g N",
      i + 1, name, at.position, length, i + 1, at.force);
  throw ParameterError(text);
}

[[noreturn]] void refuse_balance(const Passage placed[pantographs]) {
  char text[200];
  std::snprintf(
      text, sizeof text,
      "pantograph[1].force = %.10g N, pantograph[2].force = %.10g N: no equilibrium of the line under them "
      "was found, where the run would begin",
      placed[0].force, placed[1].force);
  throw ParameterError(text);
}

}  // namespace

Simulation::Simulation(const Parameters& parameters, const Inputs& inputs) : line_(parameters), hht_(line_) {
  facts_.length = line_.mesh.length();
  facts_.dropper_force_min = line_.shape.tension.size() > 0 ? line_.shape.tension.minCoeff() : 0;
  Passage placed[pantographs];
  for (int i = 0; i < pantographs; ++i) {
    const Passage& at = placed[i] = initial_passage(line_.p, i, inputs.pantograph[i]);
    if (at.force != 0 && !line_.mesh.contains(at.position)) refuse_start(line_.p, i, at, facts_.length);
  }
  std::optional<LineState> rest = hht_.at_rest(loads_at(line_.mesh, placed));
  if (!rest) refuse_balance(placed);
  state_ = *std::move(rest);
  std::copy_n(placed, pantographs, state_.passage);
  before_ = next_ = state_;
  held_ = inputs;
  if (!all_finite(outputs())) throw ParameterError(overflow);
}

bool Simulation::stays_on_line(const CommunicationStep& step, AdvanceFailure& failure) const {
  const double n = step.internal_steps();
  for (double k = 0; k <= n; ++k)
    for (int i = 0; i < pantographs; ++i) {
      const Passage here = step.at(i, k / n * step.length());
      if (here.force == 0 || line_.mesh.contains(here.position)) continue;
      failure.time = k / n * step.length();
      failure.at_end = true;
      std::snprintf(
          failure.text, sizeof failure.text,
          "pantograph[%d].x = %.10g m: must be within the line, 0 to %.10g m, while its force is %.10g N", i + 1,
          here.position, facts_.length, here.force);
      return false;
    }
  return true;
}

bool Simulation::advance(const Parameters&, const Inputs& inputs, double length, AdvanceFailure& failure) {
  if (too_long(length, line_.p.step, failure)) return false;
  if (!stays_on_line({line_, state_.passage, inputs, length}, failure)) return false;
  const CommunicationStep step(line_, state_.passage, inputs, length);
  const double n = step.internal_steps();
  const StepFactors& factors = hht_.factors(length / n);
  next_ = state_;
  Loads l0 = step.loads(0);
  hht_.jump(loads_at(line_.mesh, state_.passage), l0, next_);
  for (double k = 1; k <= n; ++k) {
    const Loads l1 = step.loads(k / n * length);
    if (!hht_.step(factors, l0, l1, next_)) {
      failure.time = k / n * length;
      std::snprintf(failure.text, sizeof failure.text, "no set of slack droppers fits, or the values overflow");
      return false;
    }
    l0 = l1;
  }
  for (int i = 0; i < pantographs; ++i) next_.passage[i] = step.at(i, length);
  std::swap(state_, next_);
  if (!all_finite(outputs())) {
    std::swap(state_, next_);
    failure.time = length;
    std::snprintf(failure.text, sizeof failure.text, overflow);
    return false;
  }
  std::swap(before_, next_);
  held_ = inputs;
  length_ = length;
  return true;
}

bool Simulation::is_possible() const {
  for (const LineState* s : {&state_, &before_}) {
    const Statistics& n = s->statistics;
    if (!(n.steps >= 0 && n.iterations >= 0 && n.iterations_max >= 0 && s->h >= 0 &&
          (s->slack.array() >= 0).all()))
      return false;
  }
  AdvanceFailure unused;
  return length_ >= 0 && !too_long(length_, line_.p.step, unused);
}

Outputs Simulation::outputs() const {
  Outputs y{};
  const LineState& s = state_;
  const auto at = [&](double x, double speed) {
    const Place place = line_.mesh.at(x);
    const Eigen::Vector4d u = place.of(s.u), height = u + place.of(line_.shape.height);
    const double velocity = place.value.dot(place.of(s.v)) + speed * place.slope.dot(height);
    return WireOutputs{place.value.dot(height), place.value.dot(u), velocity};
  };
  for (int i = 0; i < pantographs; ++i) {
    y.position[i] = s.passage[i].position;
    y.contact[i] = at(s.passage[i].position, s.passage[i].speed);
  }
  for (size_t i = 0; i < line_.mesh.supports.size(); ++i)
    y.support_uplift[i] = s.u[deflection(line_.mesh.supports[i], Contact)];
  for (int i = 0; i < most_points; ++i) y.point[i] = at(line_.p.point_position[i], 0);
  const int n = static_cast<int>(line_.mesh.droppers.size());
  y.dropper_force_min = n > 0 ? HUGE_VAL : 0;
  for (int j = 0; j < n; ++j) {
    const double force = dropper_force(j);
    y.slack += s.slack[j] > 0;
    y.dropper_force_min = std::min(y.dropper_force_min, force);
    y.dropper_force_max = std::max(y.dropper_force_max, force);
  }
  y.kinetic = s.kinetic, y.elastic = s.elastic, y.dissipated = s.dissipated, y.work = s.work;
  y.steps = s.statistics.steps;
  y.iterations = s.statistics.iterations;
  y.iterations_max = s.statistics.iterations_max;
  return y;
}

double Simulation::dropper_force(int j) const {
  if (state_.slack[j] > 0) return 0;
  return line_.shape.tension[j] + line_.shape.stiffness[j] * stretch(line_.mesh, state_.u, j);
}

void Simulation::describe_run(char* text, int size) const {
  const Statistics& n = state_.statistics;
  std::snprintf(text, static_cast<size_t>(size),
                "%.0f steps, %.3g linear systems a step for the slack droppers, at most %.0f", n.steps,
                n.steps > 0 ? n.iterations / n.steps : 0, n.iterations_max);
}

}  // namespace zspring::catenary
