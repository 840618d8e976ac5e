#include "matrices.hpp"

#include <utility>

namespace zspring::catenary {
namespace {

using Eigen::Matrix4d;
using Eigen::Vector4d;
using Triplets = std::vector<Eigen::Triplet<double>>;

// Degrees of freedom of an element: deflection and slope at its begin, then at its end.
Matrix4d beam_stiffness(const WireParameters& w, double l) {
  Matrix4d bending, tension;
  bending << 12, 6 * l, -12, 6 * l,         //
      6 * l, 4 * l * l, -6 * l, 2 * l * l,  //
      -12, -6 * l, 12, -6 * l,              //
      6 * l, 2 * l * l, -6 * l, 4 * l * l;
  tension << 36, 3 * l, -36, 3 * l,      //
      3 * l, 4 * l * l, -3 * l, -l * l,  //
      -36, -3 * l, 36, -3 * l,           //
      3 * l, -l * l, -3 * l, 4 * l * l;
  return w.EI / (l * l * l) * bending + w.tension / (30 * l) * tension;
}

Matrix4d beam_mass(const WireParameters& w, double l) {
  Matrix4d m;
  m << 156, 22 * l, 54, -13 * l,              //
      22 * l, 4 * l * l, 13 * l, -3 * l * l,  //
      54, 13 * l, 156, -22 * l,               //
      -13 * l, -3 * l * l, -22 * l, 4 * l * l;
  return w.mass * l / 420 * m;
}

}  // namespace

bool is_anchor(const Mesh& mesh, int dof) { return dof % 2 == 0 && (dof < 4 || dof >= 4 * (mesh.stations() - 1)); }

SparseMatrix hold(const SparseMatrix& matrix, const std::vector<int>& held) {
  SparseMatrix result = matrix;
  std::vector<bool> is_held(static_cast<size_t>(matrix.rows()));
  for (int dof : held) is_held[dof] = true;
  result.prune([&](int row, int column, double) { return row == column || !(is_held[row] || is_held[column]); });
  for (int dof : held) result.coeffRef(dof, dof) = 1;
  result.makeCompressed();
  return result;
}

Matrices::Matrices(const Parameters& p, const Mesh& mesh) : weight(VectorXd::Zero(mesh.dofs())) {
  Triplets stiffness, inertia;
  for (Wire wire : {Contact, Messenger}) {
    const WireParameters& w = wire == Contact ? p.contact_wire : p.messenger;
    for (int i = 0; i + 1 < mesh.stations(); ++i) {
      const double l = mesh.x[i + 1] - mesh.x[i];
      const int dof[] = {deflection(i, wire), slope(i, wire), deflection(i + 1, wire), slope(i + 1, wire)};
      const Matrix4d beam = beam_stiffness(w, l), mass_of_beam = beam_mass(w, l);
      const Vector4d load = w.mass * p.gravity * Vector4d(l / 2, l * l / 12, l / 2, -l * l / 12);
      for (int k = 0; k < 4; ++k) {
        weight[dof[k]] += load[k];
        for (int m = 0; m < 4; ++m) {
          stiffness.emplace_back(dof[k], dof[m], beam(k, m));
          inertia.emplace_back(dof[k], dof[m], mass_of_beam(k, m));
        }
      }
    }
  }
  for (int station : mesh.droppers) {
    const int contact = deflection(station, Contact), messenger = deflection(station, Messenger);
    inertia.emplace_back(contact, contact, p.dropper.clamp_contact);
    inertia.emplace_back(messenger, messenger, p.dropper.clamp_messenger);
  }
  for (size_t i = 1; i + 1 < mesh.supports.size(); ++i) {
    const int contact = deflection(mesh.supports[i], Contact), messenger = deflection(mesh.supports[i], Messenger);
    inertia.emplace_back(contact, contact, p.steady_arm.mass);
    supports.push_back({contact, p.steady_arm.stiffness});
    supports.push_back({messenger, p.support.stiffness});
  }
  std::vector<int> anchors;
  for (int dof = 0; dof < mesh.dofs(); ++dof)
    if (is_anchor(mesh, dof)) anchors.push_back(dof);
  for (auto [matrix, triplets] : {std::pair(&wires, &stiffness), std::pair(&mass, &inertia)}) {
    matrix->resize(mesh.dofs(), mesh.dofs());
    matrix->setFromTriplets(triplets->begin(), triplets->end());
    *matrix = hold(*matrix, anchors);
  }
  for (int dof : anchors) wires.coeffRef(dof, dof) = 0, weight[dof] = 0;
}

}  // namespace zspring::catenary
