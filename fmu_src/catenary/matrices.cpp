#include "matrices.hpp"

#include <array>
#include <utility>

#include "common/failure.hpp"

namespace zspring::catenary {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix4d;
using Eigen::Vector2d;
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

Matrix2d string_stiffness(double tension, double l) { return tension / l * Matrix2d{{1, -1}, {-1, 1}}; }
Matrix2d string_mass(double mass, double l) { return mass * l / 12 * Matrix2d{{5, 1}, {1, 5}}; }

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

Matrices::Matrices(const Parameters& p, const LineTable& line, const Mesh& mesh) : weight(VectorXd::Zero(mesh.dofs())) {
  Triplets stiffness, inertia;
  const auto add_element = [&](const auto& dof, const auto& k, const auto& m, const auto& load) {
    for (int i = 0; i < load.size(); ++i) {
      weight[dof[i]] += load[i];
      for (int j = 0; j < load.size(); ++j) {
        stiffness.emplace_back(dof[i], dof[j], k(i, j));
        inertia.emplace_back(dof[i], dof[j], m(i, j));
      }
    }
  };
  const auto add_beam = [&](Wire wire, int i) {
    const WireParameters& w = wire == Contact ? p.contact_wire : p.messenger;
    const double l = mesh.x[i + 1] - mesh.x[i];
    const std::array dof{deflection(i, wire), slope(i, wire), deflection(i + 1, wire), slope(i + 1, wire)};
    const Vector4d load = w.mass * p.gravity * Vector4d(l / 2, l * l / 12, l / 2, -l * l / 12);
    add_element(dof, beam_stiffness(w, l), beam_mass(w, l), load);
  };
  const auto add_string = [&](int i, int begin, int end, double tension, double mass) {
    const double l = mesh.x[i + 1] - mesh.x[i];
    const Vector2d load = mass * p.gravity * Vector2d(l / 2, l / 2);
    add_element(std::array{begin, end}, string_stiffness(tension, l), string_mass(mass, l), load);
  };
  const auto add_mass = [&](int dof, double mass) { inertia.emplace_back(dof, dof, mass); };
  const auto add_weight = [&](int dof, double mass) { add_mass(dof, mass), weight[dof] += mass * p.gravity; };

  for (int i = 0; i + 1 < mesh.stations(); ++i) add_beam(Contact, i);
  int station = 0;
  for (const StitchWire& s : line.stitches) {
    if (s.tension >= p.messenger.tension)
      refuse("a stitch wire from %.10g m on: its tension = %.10g N: must be below messenger.tension = %.10g N", s.begin,
             s.tension, p.messenger.tension);
    const int begin = mesh.station_at(s.begin), end = mesh.station_at(s.end);
    for (; station < begin; ++station) add_beam(Messenger, station);
    for (; station < end; ++station) {
      const auto stitch = [&](int i) {
        return i == begin || i == end ? deflection(i, Messenger) : stitch_deflection(i);
      };
      add_string(station, deflection(station, Messenger), deflection(station + 1, Messenger),
                 p.messenger.tension - s.tension, p.messenger.mass);
      add_string(station, stitch(station), stitch(station + 1), s.tension, s.mass);
    }
    for (int clamp : {begin, end}) add_weight(deflection(clamp, Messenger), s.clamp);
  }
  for (; station + 1 < mesh.stations(); ++station) add_beam(Messenger, station);
  for (size_t j = 0; j < line.droppers.size(); ++j) {
    add_mass(deflection(mesh.droppers[j], Contact), line.droppers[j].clamp_contact);
    add_mass(mesh.upper[j], line.droppers[j].clamp_upper);
  }
  for (const PointMass& m : line.masses)
    add_weight(deflection(mesh.station_at(m.x), m.wire == Contact ? Contact : Messenger), m.mass);
  for (size_t i = 1; i + 1 < mesh.supports.size(); ++i) {
    const int contact = deflection(mesh.supports[i], Contact), messenger = deflection(mesh.supports[i], Messenger);
    add_mass(contact, line.supports[i].arm_mass);
    supports.push_back({contact, line.supports[i].arm_stiffness});
    supports.push_back({messenger, line.supports[i].stiffness});
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
