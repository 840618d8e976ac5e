// Drives a built FMU hard and measures it: times of steps, memory, many instances, many resets, threads.
//
//   endurance LIBRARY GUID MODE COUNT STEP [iVR=VALUE | sVR=OFFSET,AMPLITUDE,FREQUENCY | oVR ...]
//
// Sets Integers (enumerations) before the start; s: a Real input that follows a sine, set before each step;
// o: a Real output that is read and compared.
// Prints one line of numbers; ends with a status other than 0 when an FMI call does not return fmi2OK.
//
//   latency    COUNT steps: median, 99 %, 99.9 %, 99.99 %, worst in us of fmi2DoStep;
//              the same of a cycle of setting the inputs, the step and reading the outputs
//   soak       COUNT steps: seconds; resident KiB after a hundredth of them and at the end
//   instances  COUNT instances alive at once, ten steps each: resident KiB an instance;
//              how many differ in their outputs
//   resets     COUNT times reset, initialization, a step: seconds; resident KiB after a hundredth
//              of them and at the end
//   threads    eight threads with an instance each, COUNT steps: how many differ from one alone
#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <thread>
#include <vector>

#include "fmi2FunctionTypes.h"

namespace {

using Clock = std::chrono::steady_clock;

void* library;
const char* guid;

template <class Function>
Function* load(const char* name) {
  auto* f = reinterpret_cast<Function*>(dlsym(library, name));
  if (!f) std::exit(3);
  return f;
}

void log(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String message, ...) {
  std::fprintf(stderr, "%s\n", message);
}

void need(fmi2Status status) {
  if (status != fmi2OK) std::exit(4);
}

struct Setting {
  char kind;
  unsigned reference;
  double value, amplitude = 0, frequency = 0;
};

class Host {
 public:
  explicit Host(const std::vector<Setting>& settings) : settings_(settings) {
    c_ = load<fmi2InstantiateTYPE>("fmi2Instantiate")("p", fmi2CoSimulation, guid, "", &callbacks, 0, 0);
    if (!c_) std::exit(5);
    initialize();
  }
  Host(const Host&) = delete;
  ~Host() { load<fmi2FreeInstanceTYPE>("fmi2FreeInstance")(c_); }

  void reset() {
    need(reset_(c_));
    initialize();
  }

  void set_inputs(double t) {
    for (const Setting& s : settings_) {
      if (s.kind != 's') continue;
      const double x = s.value + s.amplitude * std::sin(2 * M_PI * s.frequency * t);
      need(set_real_(c_, &s.reference, 1, &x));
    }
  }
  void step(double t, double h) { need(do_step_(c_, t, h, fmi2True)); }

  std::vector<double> outputs() {
    std::vector<double> y;
    for (const Setting& s : settings_)
      if (s.kind == 'o') need(get_real_(c_, &s.reference, 1, &y.emplace_back()));
    return y;
  }

 private:
  void initialize() {
    for (const Setting& s : settings_) {
      if (s.kind == 'o') continue;
      const int integer = static_cast<int>(s.value);
      need(s.kind == 'i' ? set_integer_(c_, &s.reference, 1, &integer) : set_real_(c_, &s.reference, 1, &s.value));
    }
    need(setup_(c_, 0, 0, 0, 0, 0));
    need(enter_(c_));
    need(exit_(c_));
  }

  static constexpr fmi2CallbackFunctions callbacks{log, nullptr, nullptr, nullptr, nullptr};
  const std::vector<Setting>& settings_;
  fmi2Component c_;
  fmi2ResetTYPE* reset_ = load<fmi2ResetTYPE>("fmi2Reset");
  fmi2SetupExperimentTYPE* setup_ = load<fmi2SetupExperimentTYPE>("fmi2SetupExperiment");
  fmi2EnterInitializationModeTYPE* enter_ = load<fmi2EnterInitializationModeTYPE>("fmi2EnterInitializationMode");
  fmi2ExitInitializationModeTYPE* exit_ = load<fmi2ExitInitializationModeTYPE>("fmi2ExitInitializationMode");
  fmi2SetRealTYPE* set_real_ = load<fmi2SetRealTYPE>("fmi2SetReal");
  fmi2SetIntegerTYPE* set_integer_ = load<fmi2SetIntegerTYPE>("fmi2SetInteger");
  fmi2GetRealTYPE* get_real_ = load<fmi2GetRealTYPE>("fmi2GetReal");
  fmi2DoStepTYPE* do_step_ = load<fmi2DoStepTYPE>("fmi2DoStep");
};

long resident_kib() {
  long pages = 0, resident = 0;
  if (std::FILE* f = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(f, "%ld %ld", &pages, &resident) != 2) resident = 0;
    std::fclose(f);
  }
  return resident * (sysconf(_SC_PAGESIZE) / 1024);
}

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

void print_distribution(std::vector<double>& seconds) {
  std::sort(seconds.begin(), seconds.end());
  for (double share : {0.5, 0.99, 0.999, 0.9999})
    std::printf("%.3f ", 1e6 * seconds[static_cast<size_t>(share * static_cast<double>(seconds.size() - 1))]);
  std::printf("%.3f ", 1e6 * seconds.back());
}

void run(Host& host, long count, double h) {
  for (long i = 0; i < count; ++i) {
    host.set_inputs(static_cast<double>(i + 1) * h);
    host.step(static_cast<double>(i) * h, h);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 6) return 2;
  library = dlopen(argv[1], RTLD_NOW);
  if (!library) return 3;
  guid = argv[2];
  const char* mode = argv[3];
  const long count = std::atol(argv[4]);
  const double h = std::atof(argv[5]);
  std::vector<Setting> settings;
  for (int i = 6; i < argc; ++i) {
    Setting s{};
    if (std::sscanf(argv[i], "%c%u=%lf,%lf,%lf", &s.kind, &s.reference, &s.value, &s.amplitude, &s.frequency) < 2)
      return 2;
    settings.push_back(s);
  }
  const auto begin = Clock::now();
  Host host(settings);

  if (std::strcmp(mode, "latency") == 0) {
    run(host, 1, h);
    std::vector<double> steps(static_cast<size_t>(count)), cycles(steps.size());
    for (long i = 0; i < count; ++i) {
      const auto cycle = Clock::now();
      host.set_inputs(static_cast<double>(i + 2) * h);
      const auto step = Clock::now();
      host.step(static_cast<double>(i + 1) * h, h);
      steps[static_cast<size_t>(i)] = seconds_since(step);
      host.outputs();
      cycles[static_cast<size_t>(i)] = seconds_since(cycle);
    }
    print_distribution(steps);
    print_distribution(cycles);
  } else if (std::strcmp(mode, "soak") == 0) {
    long early = 0;
    for (long i = 0; i < count; ++i) {
      host.set_inputs(static_cast<double>(i + 1) * h);
      host.step(static_cast<double>(i) * h, h);
      if (i == count / 100) early = resident_kib();
    }
    std::printf("%.1f %ld %ld", seconds_since(begin), early, resident_kib());
  } else if (std::strcmp(mode, "instances") == 0) {
    const long before = resident_kib();
    std::vector<std::unique_ptr<Host>> hosts;
    for (long i = 0; i < count; ++i) {
      hosts.push_back(std::make_unique<Host>(settings));
      run(*hosts.back(), 10, h);
    }
    run(host, 10, h);
    const std::vector<double> expected = host.outputs();
    long differ = 0;
    for (auto& other : hosts) {
      differ += other->outputs() != expected;
    }
    std::printf("%ld %ld", (resident_kib() - before) / count, differ);
  } else if (std::strcmp(mode, "resets") == 0) {
    long early = 0;
    for (long i = 0; i < count; ++i) {
      host.reset();
      run(host, 1, h);
      if (i == count / 100) early = resident_kib();
    }
    std::printf("%.1f %ld %ld", seconds_since(begin), early, resident_kib());
  } else if (std::strcmp(mode, "threads") == 0) {
    run(host, count, h);
    const std::vector<double> expected = host.outputs();
    bool same[8] = {};
    std::vector<std::thread> threads;
    for (bool& result : same)
      threads.emplace_back([&] {
        Host own(settings);
        run(own, count, h);
        result = own.outputs() == expected;
      });
    for (std::thread& t : threads) t.join();
    std::printf("%ld", static_cast<long>(std::count(same, same + 8, false)));
  } else {
    return 2;
  }
  std::printf("\n");
}
