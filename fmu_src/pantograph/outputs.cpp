#include "outputs.hpp"

namespace zspring {
namespace {

Vector5 unbalanced_force(const MechanicalState& s) {
  Vector5 f = on_masses(s.boundary.uplift) - s.internal;
  f[U1] -= s.contact_force;
  return f;
}

double head_acceleration(const Hht& hht, const MechanicalState& s) {
  if (hht.head_imposed()) return s.boundary.acceleration + s.boundary.acceleration_change;
  return unbalanced_force(s)[U1] / hht.mechanics().mass[U1];
}

}  // namespace

Vector5 acceleration(const Hht& hht, const MechanicalState& s) {
  const Vector5& mass = hht.mechanics().mass;
  Vector5 a = unbalanced_force(s);
  for (int i = 0; i < 5; ++i) a[i] = mass[i] > 0 ? a[i] / mass[i] : s.a[i];
  a[U1] = head_acceleration(hht, s);
  return a;
}

Outputs outputs(const Hht& hht, const MechanicalState& s, const BenchState& bench) {
  const Mechanics& m = hht.mechanics();
  const ZSpringGeometry spring = m.spring(s.q);
  Outputs y{};
  y.head_z = s.q[U1];
  y.head_v = s.v[U1];
  y.head_a = head_acceleration(hht, s);
  y.upper_frame_z = s.q[U2];
  y.upper_frame_v = s.v[U2];
  y.lower_frame_z = s.q[U3];
  y.lower_frame_v = s.v[U3];
  y.contact_force = s.contact_force;
  y.contact_closed = m.parameters.drive != Drive::Wire || s.contact_force > 0;
  y.alpha = s.q[ALPHA];
  y.beta = s.q[BETA];
  y.spring_length = spring.length;
  y.spring_force = spring.tension;
  y.moment_alpha = m.moment_bound[0] * s.s[0];
  y.moment_beta = m.moment_bound[1] * s.s[1];
  y.kinetic = m.kinetic_energy(s.v);
  y.elastic = m.strain_energy(s.q);
  y.dissipated = s.dissipated;
  y.work = s.work;
  y.iterations = s.statistics.iterations;
  y.iterations_max = s.statistics.iterations_max;
  y.steps = s.statistics.steps;
  y.refinements = s.statistics.refinements;
  y.H_re = bench.H_re;
  y.H_im = bench.H_im;
  y.H_change = bench.change;
  y.periods = bench.periods;
  return y;
}

Outputs outputs_change(const Hht& hht, const MechanicalState& s, const MechanicalState& d) {
  const Mechanics& m = hht.mechanics();
  const ZSpringGeometry spring = m.spring(s.q);
  const double stretch = spring.gradient.dot(d.q.head<4>());
  Vector5 spring_force;
  Matrix4 head_tangent;
  Outputs y{};
  y.head_z = d.q[U1];
  y.head_v = d.v[U1];
  y.head_a = head_acceleration(hht, d);
  y.upper_frame_z = d.q[U2];
  y.upper_frame_v = d.v[U2];
  y.lower_frame_z = d.q[U3];
  y.lower_frame_v = d.v[U3];
  y.contact_force = d.contact_force;
  y.alpha = d.q[ALPHA];
  y.beta = d.q[BETA];
  y.spring_length = stretch;
  y.spring_force = m.parameters.zspring.k * stretch;
  y.moment_alpha = m.moment_bound[0] * d.s[0];
  y.moment_beta = m.moment_bound[1] * d.s[1];
  y.kinetic = d.v.dot(m.mass.cwiseProduct(s.v));
  if (m.springs(s.q, spring_force, head_tangent)) y.elastic = d.q.dot(spring_force + m.preload);
  y.dissipated = d.dissipated;
  y.work = d.work;
  return y;
}

}  // namespace zspring
