#include "static_shape.hpp"

#include "block_cholesky.hpp"
#include "common/failure.hpp"

namespace zspring::catenary {
namespace {

// Deflections of the wires under `load` N, some degrees of freedom held at heights.
VectorXd hang(const SparseMatrix& wires, const VectorXd& load, const std::vector<int>& held, const VectorXd& heights) {
  VectorXd given = VectorXd::Zero(load.size());
  for (size_t i = 0; i < held.size(); ++i) given[held[i]] = heights[static_cast<Eigen::Index>(i)];
  VectorXd x = load - wires * given;
  for (int dof : held) x[dof] = given[dof];
  BlockCholesky(hold(wires, held)).solve(x);
  return x;
}

[[noreturn]] void refuse_dropper(const Parameters& p, int dropper, const Text& reason) {
  const int i = dropper % p.dropper.count;
  refuse("dropper.position[%d] = %.10g m, dropper.sag[%d] = %.10g m: %s", i + 1, p.dropper.position[i], i + 1,
         p.dropper.sag[i], reason.chars);
}

}  // namespace

StaticShape static_shape(const Parameters& p, const Mesh& mesh, const Matrices& m) {
  const int n = static_cast<int>(mesh.droppers.size()), last = mesh.stations() - 1;
  StaticShape shape;
  shape.tension.resize(n), shape.length.resize(n), shape.stiffness.resize(n);

  std::vector<int> held;
  std::vector<double> heights;
  const auto hold_at = [&](int dof, double height) { held.push_back(dof), heights.push_back(height); };
  const auto hanging = [&](const VectorXd& load) {
    return hang(m.wires, load, held, Eigen::Map<const VectorXd>(heights.data(), static_cast<int>(heights.size())));
  };
  // The matrices hold the anchors at 0: the messenger's heights are counted from the encumbrance.
  for (int station : {0, last}) hold_at(deflection(station, Contact), 0), hold_at(deflection(station, Messenger), 0);
  for (size_t i = 1; i + 1 < mesh.supports.size(); ++i) hold_at(deflection(mesh.supports[i], Messenger), 0);
  for (int j = 0; j < n; ++j) hold_at(deflection(mesh.droppers[j], Contact), -p.dropper.sag[j % p.dropper.count]);
  const VectorXd contact_wire = hanging(-m.weight);
  const VectorXd carried = m.wires * contact_wire + m.weight;

  // The droppers' own weight depends on their lengths, and these on the messenger's sag under it.
  double half_weight_change = 1;
  VectorXd half_weight = VectorXd::Zero(n);
  for (int pass = 0; pass < 100 && half_weight_change > 1e-12; ++pass) {
    VectorXd load = -m.weight;
    for (int j = 0; j < n; ++j) {
      shape.tension[j] =
          carried[deflection(mesh.droppers[j], Contact)] + p.dropper.clamp_contact * p.gravity + half_weight[j];
      load[deflection(mesh.droppers[j], Messenger)] -=
          shape.tension[j] + p.dropper.clamp_messenger * p.gravity + half_weight[j];
    }
    shape.height = hanging(load);
    for (int station = 0; station <= last; ++station)
      shape.height[deflection(station, Messenger)] += p.line.encumbrance;
    for (int j = 0; j < n; ++j)
      shape.length[j] =
          shape.height[deflection(mesh.droppers[j], Messenger)] - shape.height[deflection(mesh.droppers[j], Contact)];
    const VectorXd now = 0.5 * p.dropper.mass * p.gravity * shape.length;
    half_weight_change = n > 0 ? (now - half_weight).cwiseAbs().maxCoeff() : 0;
    half_weight = now;
  }
  for (int j = 0; j < n; ++j) {
    if (!(shape.length[j] > 0))
      refuse_dropper(p, j, text("the dropper would be %.6g m long; line.encumbrance must be larger", shape.length[j]));
    if (!(shape.tension[j] >= 0))
      refuse_dropper(p, j, text("in the static state the dropper would have to push, with %.6g N", -shape.tension[j]));
    shape.stiffness[j] = p.dropper.EA > 0 ? p.dropper.EA / shape.length[j] : p.dropper.stiffness;
  }
  return shape;
}

}  // namespace zspring::catenary
