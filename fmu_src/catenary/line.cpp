#include "line.hpp"

#include "droppers.hpp"

namespace zspring::catenary {

Line::Line(const Parameters& parameters)
    : p(parameters), mesh(p), matrices(p, mesh), shape(static_shape(p, mesh, matrices)) {
  for (size_t j = 0; j < mesh.droppers.size(); ++j) {
    const double half = 0.5 * p.dropper.mass * shape.length[static_cast<Eigen::Index>(j)];
    for (Wire wire : {Contact, Messenger}) {
      const int dof = deflection(mesh.droppers[j], wire);
      matrices.mass.coeffRef(dof, dof) += half;
    }
  }
}

LineState LineState::at_rest(const Line& line) {
  LineState s;
  s.u = s.v = s.a = s.a_slope = s.internal = s.damping = VectorXd::Zero(line.mesh.dofs());
  s.slack = VectorXd::Zero(line.shape.tension.size());
  return s;
}

void LineState::set_zero() {
  for (VectorXd* x : {&u, &v, &a, &a_slope, &internal, &damping, &slack}) x->setZero();
  h = kinetic = elastic = dissipated = work = 0;
}

void Line::add_springs(const VectorXd& u, VectorXd& internal) const {
  for (const Spring& s : matrices.supports) internal[s.dof] += s.stiffness * u[s.dof];
  for (int j = 0; j < static_cast<int>(mesh.droppers.size()); ++j)
    add_tension(mesh, j, shape.stiffness[j] * stretch(mesh, u, j), internal);
}

SparseMatrix Line::stiffness() const {
  SparseMatrix k = matrices.wires;
  for (const Spring& s : matrices.supports) k.coeffRef(s.dof, s.dof) += s.stiffness;
  for (size_t j = 0; j < mesh.droppers.size(); ++j) {
    const int contact = deflection(mesh.droppers[j], Contact), messenger = deflection(mesh.droppers[j], Messenger);
    const double stiffness = shape.stiffness[static_cast<Eigen::Index>(j)];
    k.coeffRef(contact, contact) += stiffness, k.coeffRef(messenger, messenger) += stiffness;
    k.coeffRef(contact, messenger) -= stiffness, k.coeffRef(messenger, contact) -= stiffness;
  }
  k.makeCompressed();
  return k;
}

}  // namespace zspring::catenary
