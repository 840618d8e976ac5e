// A communication step in internal steps: what acts during it, and how the state goes through it.
#pragma once

#include <optional>

#include "bench.hpp"
#include "common/time.hpp"
#include "hht.hpp"
#include "imposed_motion.hpp"

namespace zspring {

struct SimulationState {
  MechanicalState mechanical;
  MotionState motion;  // Drive::Displacement: the head; Drive::Wire: the wire
  BenchState bench;
};
ZSPRING_MEMBERS(SimulationState, mechanical, motion, bench)

// What holds during one communication step.
struct Held {
  Inputs inputs;
  BenchParameters bench;
  double length = 0;  // s; 0 before the first step
};
ZSPRING_MEMBERS(Held, inputs, bench, length)

// An internal step, `time` s since the begin of the communication step, that Newton did not solve, however short.
Discard unsolved(double time, const Convergence& end);

// What jumps at a communication point where the surroundings become `b0`: the state, or the linear part of it for
// variations of both.
void meet(const Hht& hht, const Boundary& b0, MechanicalState& s);
void meet_variation(const Hht& hht, const Boundary& db0, MechanicalState& d);

const Signal& position_input(Drive drive, const Inputs& u);
void set_forces(const Inputs& u, double tau, Boundary& b);
// Positions closer in time are not told apart, where communication steps are uneven, s.
inline double resolved_time(const Parameters& p) { return p.solver.step / 16; }
double largest_internal_step(const Parameters& p, const Held& held);  // s

class CommunicationStep {
 public:
  CommunicationStep(const Hht& hht, const Held& held) : hht_(hht), p_(hht.mechanics().parameters), held_(held) {}

  // Leads `state` through it.
  std::optional<Discard> run(SimulationState& state) const;
  // The same with what the position does in it, for a wire that gives way what it did; on_step(from, to) sees each
  // internal step that was made.
  template <class OnStep>
  std::optional<Discard> run_along(const Signal& position, SimulationState& state, OnStep&& on_step) const {
    return p_.drive == Drive::Bench ? run_bench(state, on_step) : run_inputs(state, position, on_step);
  }
  bool gives_way() const { return p_.drive == Drive::Wire && held_.inputs.wire.gives_way(); }

 private:
  // The state that is led through the internal steps, and room for the next one: they change places.
  struct Course {
    explicit Course(MechanicalState& state) : kept(state), now(&state), next(&room) {}
    ~Course() {
      if (now != &kept) kept = *now;
    }

    MechanicalState& kept;
    MechanicalState room;
    MechanicalState *now, *next;
  };
  static constexpr int most_halvings = 10;  // to 1/1024 of the internal step
  static constexpr int most_meetings = 60;  // of a wire that gives way with the head

  template <class OnStep>
  std::optional<Discard> run_bench(SimulationState& state, OnStep& on_step) const {
    Course course(state.mechanical);
    Bench bench(state.bench);
    bench.tune(held_.bench, p_.solver.step);
    const double rounding = rounding_of_time * bench.grid_step();
    const double end_time = held_.length + state.bench.carry;
    double done = 0;                          // s since the begin of the communication step, at a node or a cut
    double next_node = bench.to_next_node();  // s likewise; counted from the first, so that rounding does not add up
    const double first_node = next_node;
    Count nodes = 0;

    const auto boundary = [&](double tau, Boundary& b) {
      set_forces(held_.inputs, tau, b);
      return bench.motion(tau - done, b);
    };
    Boundary b;
    Phasor begin = boundary(0, b);
    meet(hht_, b, *course.now);
    while (end_time - done > rounding) {
      const bool reaches_node = end_time >= next_node - rounding;
      const double h = reaches_node ? bench.to_next_node() : end_time - done;
      set_forces(held_.inputs, done + h, b);
      const Phasor end = bench.motion(h, b);
      const double force = course.now->contact_force - p_.static_force;
      if (std::optional<Discard> discard = cover(course, boundary, b, done, h, 0, on_step)) return discard;
      bench.advance(h, reaches_node, begin, force, end, course.now->contact_force - p_.static_force);
      begin = end;
      done = reaches_node ? next_node : end_time;
      if (reaches_node) next_node = first_node + ++nodes * bench.grid_step();
    }
    state.bench.carry = end_time - done;
    return std::nullopt;
  }

  std::optional<Discard> meet_wire(SimulationState& state) const;

  template <class OnStep>
  std::optional<Discard> run_inputs(SimulationState& state, const Signal& position, OnStep& on_step) const {
    const double H = held_.length;
    Course course(state.mechanical);
    std::optional<ImposedMotion> motion;
    if (p_.drive != Drive::Force) motion.emplace(state.motion, position, H, resolved_time(p_));
    const auto boundary = [&](double tau, Boundary& b) {
      set_forces(held_.inputs, tau, b);
      if (motion) motion->at(tau, b);
    };
    const Count n = internal_steps(H, p_.solver.step);
    const double steps = static_cast<double>(n);
    Boundary b;
    boundary(0, b);
    meet(hht_, b, *course.now);
    for (Count i = 0; i < n; ++i) {
      boundary((i + 1) / steps * H, b);
      if (std::optional<Discard> discard = cover(course, boundary, b, i / steps * H, H / steps, 0, on_step))
        return discard;
    }
    if (motion) state.motion = motion->end();
    return std::nullopt;
  }

  // One internal step of h s to the boundary `b`, halved as often as it takes.
  template <class BoundaryAt, class OnStep>
  std::optional<Discard> cover(Course& course, const BoundaryAt& boundary, const Boundary& b, double begin, double h,
                               int halvings, OnStep& on_step) const {
    MechanicalState &s = *course.now, &next = *course.next;
    const double h_last = s.h, hht_alpha = p_.solver.hht_alpha;
    move_memory(hht_alpha, h_last, h, s.a_slope, s.a);
    const Convergence end = hht_.step(s, b, h, next);
    s.statistics.add_attempt(end.iterations);
    if (end.reached) {
      next.statistics = s.statistics;
      next.statistics.steps += 1;
      on_step(s, next);
      std::swap(course.now, course.next);
      return std::nullopt;
    }
    if (halvings == most_halvings) return unsolved(begin, end);
    move_memory(hht_alpha, h, h_last, s.a_slope, s.a);
    s.statistics.refinements += 1;
    Boundary middle;
    boundary(begin + 0.5 * h, middle);
    if (std::optional<Discard> discard = cover(course, boundary, middle, begin, 0.5 * h, halvings + 1, on_step))
      return discard;
    return cover(course, boundary, b, begin + 0.5 * h, 0.5 * h, halvings + 1, on_step);
  }

  const Hht& hht_;
  const Parameters& p_;
  const Held& held_;
};

}  // namespace zspring
