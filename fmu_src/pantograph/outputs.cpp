#include "simulation.hpp"

namespace zspring {
namespace {

// What the definitions are written with.
struct View {
  View(const Hht& integrator, const SimulationState& state)
      : hht(integrator), m(hht.mechanics()), s(state.mechanical), bench(state.bench) {
    if (!m.head_response(s.q, head)) head = {};  // not reached: the spring of an accepted state has a direction
  }

  const Hht& hht;
  const Mechanics& m;
  const MechanicalState& s;
  const BenchState& bench;
  ElementResponse head;
};

double stretch(const View& x, const MechanicalState& d) { return x.head.gradient.dot(d.q.head<4>()); }

double elastic_change(const View& x, const MechanicalState& d) {
  return d.q.dot(x.m.spring_force(x.s.q, x.head) + x.m.preload);
}

}  // namespace

LINEAR(head_dot_z, q[U1])
LINEAR(head_dot_v, v[U1])
OUTPUT(head_dot_a, x.hht.head_acceleration(x.s), x.hht.head_acceleration(d))
LINEAR(upper_frame_dot_z, q[U2])
LINEAR(upper_frame_dot_v, v[U2])
LINEAR(lower_frame_dot_z, q[U3])
LINEAR(lower_frame_dot_v, v[U3])
LINEAR(contact_dot_force, contact_force)
DISCRETE(contact_dot_closed, x.m.parameters.drive != Drive::Wire || x.s.contact_force > 0)
LINEAR(zspring_dot_alpha, q[ALPHA])
LINEAR(zspring_dot_beta, q[BETA])
OUTPUT(zspring_dot_length, x.head.length, stretch(x, d))
OUTPUT(zspring_dot_force, x.head.tension, x.m.parameters.zspring.k* stretch(x, d))
OUTPUT(zspring_dot_moment_alpha, x.m.moment_bound[0] * x.s.s[0], x.m.moment_bound[0] * d.s[0])
OUTPUT(zspring_dot_moment_beta, x.m.moment_bound[1] * x.s.s[1], x.m.moment_bound[1] * d.s[1])
OUTPUT(energy_dot_kinetic, x.m.kinetic_energy(x.s.v), d.v.dot(x.m.mass.cwiseProduct(x.s.v)))
OUTPUT(energy_dot_elastic, x.m.strain_energy(x.s.q, x.head), elastic_change(x, d))
LINEAR(energy_dot_dissipated, dissipated)
LINEAR(energy_dot_work, work)
DISCRETE(solver_dot_iterations, x.s.statistics.iterations)
DISCRETE(solver_dot_iterations_max, x.s.statistics.iterations_max)
DISCRETE(solver_dot_steps, x.s.statistics.steps)
DISCRETE(solver_dot_refinements, x.s.statistics.refinements)
DISCRETE(bench_dot_H_re, x.bench.H_re)
DISCRETE(bench_dot_H_im, x.bench.H_im)
DISCRETE(bench_dot_change, x.bench.change)
DISCRETE(bench_dot_periods, x.bench.periods)
DISCRETE(bench_dot_steps_per_period, steps_in_period(x.m.parameters.bench.frequency, x.m.parameters.solver.step))
DISCRETE(bench_dot_harmonic, x.bench.harmonic[i])

Outputs Simulation::present_outputs() const { return output_values(View(hht_, state_)); }
Outputs Simulation::change(const MechanicalState& d) const { return output_changes(View(hht_, state_), d); }

}  // namespace zspring
