#include "line.hpp"

#include <utility>

#include "droppers.hpp"

namespace zspring::catenary {

Line::Line(const Parameters& parameters, LineTable built)
    : p(parameters),
      table(std::move(built)),
      mesh(table, p.mesh.element),
      matrices(p, table, mesh),
      shape(static_shape(p, table, mesh, matrices)) {
  for (size_t j = 0; j < mesh.droppers.size(); ++j) {
    const double half = 0.5 * table.droppers[j].mass * shape.length[static_cast<Eigen::Index>(j)];
    for (int dof : {deflection(mesh.droppers[j], Contact), mesh.upper[j]}) matrices.mass.coeffRef(dof, dof) += half;
  }
}

LineState LineState::at_rest(const Line& line) {
  LineState s;
  s.u = s.v = s.a = s.a_slope = s.internal = s.damping = VectorXd::Zero(line.mesh.dofs());
  s.slack = VectorXd::Zero(line.shape.tension.size());
  return s;
}

void Variation::clear() {
  for (VectorXd* x : {&d.u, &d.v, &d.a, &d.a_slope, &d.internal}) x->segment(4 * on.begin, 4 * on.count()).setZero();
  d.slack.setZero();
  d.h = d.kinetic = d.elastic = d.dissipated = d.work = 0;
  on = {0, 0};
}

void Variation::take_over(const Variation& other) {
  on = other.on;
  const auto copy = [&](const VectorXd& from, VectorXd& to) {
    to.segment(4 * on.begin, 4 * on.count()) = from.segment(4 * on.begin, 4 * on.count());
  };
  copy(other.d.u, d.u), copy(other.d.v, d.v), copy(other.d.a, d.a);
  copy(other.d.a_slope, d.a_slope), copy(other.d.internal, d.internal);
  d.slack = other.d.slack;
  d.h = other.d.h;
}

void Variation::add_to(LineState& s, double factor) const {
  const auto in = [&](auto& x) { return x.segment(4 * on.begin, 4 * on.count()); };
  in(s.u) += factor * in(d.u);
  in(s.v) += factor * in(d.v);
  in(s.a) += factor * in(d.a);
  in(s.a_slope) += factor * in(d.a_slope);
  in(s.internal) += factor * in(d.internal);
  s.slack += factor * d.slack;
}

void Line::add_springs(double factor, const VectorXd& u, VectorXd& forces) const {
  for (const Spring& s : matrices.supports) forces[s.dof] += factor * s.stiffness * u[s.dof];
  for (int j = 0; j < static_cast<int>(mesh.droppers.size()); ++j)
    add_tension(mesh, j, factor * shape.stiffness[j] * stretch(mesh, u, j), forces);
}

SparseMatrix Line::stiffness() const {
  std::vector<Eigen::Triplet<double>> springs;
  for (const Spring& s : matrices.supports) springs.emplace_back(s.dof, s.dof, s.stiffness);
  SparseMatrix k(mesh.dofs(), mesh.dofs());
  k.setFromTriplets(springs.begin(), springs.end());
  return matrices.wires + k + dropper_stiffness(mesh, shape.stiffness);
}

}  // namespace zspring::catenary
