// Finite-element matrices of the two wires: tensioned Euler-Bernoulli beams with consistent mass.
#pragma once

#include "mesh.hpp"
#include "sparse.hpp"

namespace zspring::catenary {

struct Spring {
  int dof;
  double stiffness;  // N/m
};

// The anchors hold the deflection of both wires at both ends: their rows are those of a free unit mass that
// nothing loads.
struct Matrices {
  explicit Matrices(const Parameters& p, const Mesh& mesh);

  SparseMatrix wires;            // stiffness of the wires alone
  SparseMatrix mass;             // with clamps and steady arms; droppers are added with their lengths
  std::vector<Spring> supports;  // messenger supports and steady arms
  VectorXd weight;               // N and N m, of the wires alone, downward positive
};

bool is_anchor(const Mesh& mesh, int dof);
// The matrix with rows and columns of `held` degrees of freedom replaced by unity.
SparseMatrix hold(const SparseMatrix& matrix, const std::vector<int>& held);

}  // namespace zspring::catenary
