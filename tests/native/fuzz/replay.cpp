// The same sequences without libFuzzer:
//
//   fuzz_MODEL FILE...                          replays files
//   fuzz_MODEL --random FIRST COUNT [THREADS]   runs COUNT random sequences a thread, seeded from FIRST on
//   fuzz_MODEL --write FIRST COUNT FOLDER       writes such sequences as files, to start libFuzzer from
//
// The search path for libraries tells where the FMU's is, but for programs with sanitizers: it is inside.
// Prints what was done; a fault ends it.
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>
#include <thread>

#include "calls.hpp"

using namespace fuzz;

namespace {

thread_local std::uint64_t seed = 0;  // of the present sequence

void tell_seed(int) { std::fprintf(stderr, "  seed %llu\n", static_cast<unsigned long long>(seed)); }

std::vector<std::uint8_t> random_bytes(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<std::uint8_t> bytes(200 + random() % 800);
  for (std::uint8_t& b : bytes) b = static_cast<std::uint8_t>(random());
  return bytes;
}

void add(Counts& sum, const Counts& c) {
  sum.calls += c.calls, sum.refused += c.refused, sum.steps += c.steps, sum.discarded += c.discarded;
  sum.states += c.states, sum.foreign_states += c.foreign_states, sum.replays += c.replays;
  sum.situations.insert(c.situations.begin(), c.situations.end());
}

}  // namespace

int main(int argc, char** argv) {
  Counts sum;
  if (argc >= 4 && std::string(argv[1]) == "--random") {
    std::signal(SIGABRT, tell_seed);
    const auto first = std::strtoull(argv[2], nullptr, 10), count = std::strtoull(argv[3], nullptr, 10);
    const unsigned threads = argc > 4 ? static_cast<unsigned>(std::atoi(argv[4])) : 1;
    std::vector<Counts> counts(threads);
    std::vector<std::thread> running;
    for (unsigned t = 0; t < threads; ++t)
      running.emplace_back([&, t] {
        for (std::uint64_t k = 0; k < count; ++k) {
          seed = first + t * count + k;
          const std::vector<std::uint8_t> bytes = random_bytes(seed);
          add(counts[t], run(bytes.data(), bytes.size()));
        }
      });
    for (std::thread& t : running) t.join();
    for (const Counts& c : counts) add(sum, c);
  } else if (argc == 5 && std::string(argv[1]) == "--write") {
    for (long k = 0; k < std::atol(argv[3]); ++k) {
      const long number = std::atol(argv[2]) + k;
      const std::vector<std::uint8_t> bytes = random_bytes(static_cast<std::uint64_t>(number));
      std::ofstream(std::string(argv[4]) + "/random-" + std::to_string(number), std::ios::binary)
          .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    }
  } else {
    for (int i = 1; i < argc; ++i) {
      std::ifstream file(argv[i], std::ios::binary);
      if (!file) {
        std::fprintf(stderr, "cannot read %s\n", argv[i]);
        return 2;
      }
      const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
      add(sum, run(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()));
    }
  }
  std::printf(
      "calls %lu, refused %lu, steps %lu, discarded %lu, states %lu, foreign %lu, replays %lu, "
      "situations %zu\n",
      sum.calls, sum.refused, sum.steps, sum.discarded, sum.states, sum.foreign_states, sum.replays,
      sum.situations.size());
}
