// The time that the core alone needs for the standard figure: what driving it through FMI is measured against.
//
//   core_benchmark FRICTION PERIODS, FRICTION 1 Regularized or 2 Coulomb; frequency and acceleration from
//   standard input, a pair a line. Prints internal steps and seconds.
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "fmi/variables.hpp"

using namespace zspring;

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  Parameters p;
  for (const fmi::Variable& v : fmi::variables)
    if (v.is_parameter()) v.set(p, v.start);
  p.drive = Drive::Bench;
  p.friction = static_cast<Friction>(std::atoi(argv[1]));

  double steps = 0, seconds = 0, frequency, acceleration;
  while (std::scanf("%lf %lf", &frequency, &acceleration) == 2) {
    const auto begin = std::chrono::steady_clock::now();
    p.bench = {frequency, acceleration};
    Simulation simulation(p, Inputs());
    if (simulation.advance(Inputs(), std::atof(argv[2]) / frequency)) return 1;
    steps += static_cast<double>(simulation.statistics().steps);
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }
  std::printf("%.0f %.6f\n", steps, seconds);
}
