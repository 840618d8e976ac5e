// Tables of lines with some of their numbers damaged: refused, or a line that moves. Linked with the core itself.
//
//   fuzz_line_table FIRST COUNT      seeded from FIRST on; prints how many were refused and how many moved
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "bytes.hpp"
#include "variables.hpp"
#include "variables.inc"

using namespace zspring;
using catenary::LineTable;

namespace {

std::vector<double> sound_table() {
  return {3,                                                                                          // supports
          0,   1.4, 0,    0,   0,    50,    1.5, 5e4,  0.3, 300,   90, 1.4, 0,    0,   0,   0, 0.09,  //
          5,                                                                                          // droppers
          10,  0,   0.01, 1e5, 0,    0.1,   0.2, 0.2,  0,   0.002, 30, 0,   0.03, 1e5, 2e5,           //
          0.1, 0.2, 0.2,  0,   0,    47,    1,   0.04, 1e5, 0,     0,  0,   0,    0,   0,             //
          53,  1,   0.05, 1e5, 0,    0,     0,   0,    1.2, 0,     70, 0,   0.07, 1e5, 0,   0, 0,    0, 0, 10,
          1,                             // stitch wires
          42,  58,  2800, 0.3, 0.4,      //
          2,                             // point masses
          20,  0,   3,    50,  1,    5,  //
          3,                             // profile
          10,  0,   0,    20,  0.01, 0.001, 80,  0,    0};
}

std::vector<char> bytes_of(const std::vector<double>& numbers) {
  constexpr std::size_t head = sizeof LineTable::magic - 1;
  std::vector<char> bytes(head + numbers.size() * sizeof(double));
  std::memcpy(bytes.data(), LineTable::magic, head);
  std::memcpy(bytes.data() + head, numbers.data(), bytes.size() - head);
  return bytes;
}

fmi::Parameters starts() {
  fmi::Parameters p;
  for (const fmi::Variable& v : fmi::variables)
    if (v.is_parameter()) v.set(p, v.start);
  p.mesh.element = 5;
  p.pantograph[0].start = 20;
  return p;
}

// Whether it was a line.
bool try_table(const std::vector<char>& bytes, const fmi::Parameters& p) {
  try {
    const LineTable table = LineTable::of(bytes.data(), bytes.size());
    if (table.length() > 1000) refuse("too long to wait for");
    fmi::Inputs u{};
    u.pantograph[0].force.value = 100, u.pantograph[0].speed.value = 50;
    fmi::Simulation line(p, u, &table);
    for (int i = 0; i < 3; ++i) line.advance(u, 0.01);
    for (double y : line.outputs())
      if (!std::isfinite(y)) std::abort();
    return true;
  } catch (const Refusal& e) {
    if (!*e.what()) std::abort();
    return false;
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const fmi::Parameters p = starts();
  if (!try_table(bytes_of(sound_table()), p)) std::abort();
  unsigned long refused = 0, moved = 0;
  const unsigned long first = std::strtoul(argv[1], nullptr, 10), count = std::strtoul(argv[2], nullptr, 10);
  for (unsigned long seed = first; seed < first + count; ++seed) {
    std::mt19937_64 random(seed);
    std::vector<std::uint8_t> choices(40);
    for (std::uint8_t& c : choices) c = static_cast<std::uint8_t>(random());
    fuzz::Bytes in(choices.data(), choices.size());
    std::vector<double> numbers = sound_table();
    for (unsigned changes = 1 + in.below(3); changes > 0; --changes) {
      double& number = numbers[random() % numbers.size()];
      number = in.one_in(2) ? number + in.finite_number() : in.number();
    }
    std::vector<char> bytes = bytes_of(numbers);
    if (in.one_in(8)) bytes.resize(random() % bytes.size());
    if (in.one_in(8)) bytes[random() % bytes.size()] ^= static_cast<char>(1 << in.below(8));
    ++(try_table(bytes, p) ? moved : refused);
  }
  std::printf("refused %lu, moved %lu\n", refused, moved);
}
