// Finite-element matrices of the wires: tensioned Euler-Bernoulli beams with consistent mass; strings along a stitch.
//
// The mass of a string's element is the mean of the consistent and the lumped one: waves along it then run at their
// speed but for terms of fourth order in the element's length (Goudreau, Taylor: Computer Methods in Applied Mechanics
// and Engineering 2, 1973).
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
  // Throws Refusal where a stitch wire takes all of the messenger's tension.
  Matrices(const Parameters& p, const LineTable& line, const Mesh& mesh);

  SparseMatrix wires;            // stiffness of the wires alone
  SparseMatrix mass;             // with clamps, point masses and steady arms; droppers are added with their lengths
  std::vector<Spring> supports;  // messenger supports and steady arms
  VectorXd weight;               // N and N m, of wires, point masses and stitch clamps, downward positive
};

bool is_anchor(const Mesh& mesh, int dof);
// The matrix with rows and columns of `held` degrees of freedom replaced by unity.
SparseMatrix hold(const SparseMatrix& matrix, const std::vector<int>& held);

}  // namespace zspring::catenary
