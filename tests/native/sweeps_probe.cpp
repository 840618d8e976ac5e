// Whether the sweeps over the line's stations give the same bits on both kinds of x86-64 processors: prints "same",
// "different" or, where this machine has one kind alone, "one kind".
#include "catenary/sweeps.cpp"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <vector>

using namespace zspring::catenary;

#if defined(__GNUC__) && defined(__x86_64__) && (defined(__clang__) || !defined(_WIN32))
namespace {

constexpr int stations = 61;
using Numbers = std::vector<double>;

double random_number() { return 2 * (std::rand() / static_cast<double>(RAND_MAX)) - 1; }
Numbers random_numbers(size_t n) {
  Numbers x(n);
  for (double& value : x) value = random_number();
  return x;
}
std::vector<StationRow> random_rows() {
  std::vector<StationRow> rows(stations);
  for (StationRow& row : rows)
    for (StationRow::Block* block : {&row.before, &row.here, &row.after})
      for (int i = 0; i < 4; ++i) block->straight[i] = random_number(), block->crossed[i] = random_number();
  return rows;
}
std::vector<FactorBlock> random_blocks() {
  std::vector<FactorBlock> blocks(stations);
  for (FactorBlock& block : blocks)
    for (auto& column : block.column)
      for (double& value : column) value = 0.2 * random_number();
  return blocks;
}

struct Sweeps {
  decltype(&sweeps::multiply) multiply;
  decltype(&sweeps::predict) predict;
  decltype(&sweeps::correct) correct;
  decltype(&sweeps::account) account;
  decltype(&sweeps::solve) solve;
  decltype(&sweeps::solve_locally) solve_locally;
};

// All that the sweeps leave behind, from numbers that are the same each time.
Numbers results(const Sweeps& s) {
  std::srand(1);
  const auto wires = random_rows(), mass = random_rows();
  const auto inverse = random_blocks(), forward = random_blocks(), backward = random_blocks();
  std::array<Numbers, 8> x;
  for (Numbers& vector : x) vector = random_numbers(4 * stations);
  const sweeps::Operators op{wires.data(), mass.data(), 1e-3, 0.05};
  const zspring::HhtCoefficients c(-0.1, 1e-3);
  const zspring::catenary::Range on{3, 50};
  auto& [u, v, a, internal, right, slope, damping, local] = x;
  s.predict(op, c, on, {u.data(), v.data(), a.data(), internal.data(), u.data(), v.data(), right.data()});
  s.solve({inverse.data(), forward.data(), backward.data(), stations}, right.data());
  s.correct(op, c, on, {right.data(), internal.data(), a.data(), u.data(), v.data(), internal.data(), slope.data()});
  const sweeps::Products p = s.account(op, on, {u.data(), v.data(), internal.data(), a.data(), damping.data()});
  s.multiply(wires.data(), on, u.data(), a.data());
  for (int i = 0; i < 4 * stations; ++i)
    if (i / 4 != 20) local[i] = 0;
  const zspring::catenary::Range found =
      s.solve_locally({inverse.data(), forward.data(), backward.data(), stations}, {20, 21}, local.data());
  Numbers all{p.v_mass_v, p.old_v_damping, p.v_damping, p.u_internal, p.u_damping};
  all.push_back(found.begin), all.push_back(found.end);
  for (const Numbers& vector : x) all.insert(all.end(), vector.begin(), vector.end());
  return all;
}

}  // namespace

int main() {
  if (!sweeps::has_avx2) return std::puts("one kind"), 0;
  using namespace sweeps;
  const Numbers any = results({multiply_any, predict_any, correct_any, account_any, solve_any, solve_locally_any});
  const Numbers avx2 =
      results({multiply_avx2, predict_avx2, correct_avx2, account_avx2, solve_avx2, solve_locally_avx2});
  std::puts(any.size() == avx2.size() && std::memcmp(any.data(), avx2.data(), any.size() * sizeof(double)) == 0
                ? "same"
                : "different");
}
#else
int main() { std::puts("one kind"); }
#endif
