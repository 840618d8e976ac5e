// Counts heap allocations inside fmi2DoStep of a built FMU.
//
//   count_allocations LIBRARY GUID RESOURCES STEP COUNT [rVR=VALUE | iVR=VALUE ...]   sets Reals and
//   Integers (enumerations), then runs COUNT steps of STEP s and prints the allocations in all fmi2DoStep calls and, to
//   show that counting works, in one fmi2Instantiate.
#include <dlfcn.h>

#include <cstdio>
#include <cstdlib>

#include "fmi2FunctionTypes.h"

static long allocations = 0;

extern "C" {
void* __libc_malloc(size_t);
void* __libc_calloc(size_t, size_t);
void* __libc_realloc(void*, size_t);
void* __libc_memalign(size_t, size_t);

void* malloc(size_t n) {
  ++allocations;
  return __libc_malloc(n);
}
void* calloc(size_t n, size_t size) {
  ++allocations;
  return __libc_calloc(n, size);
}
void* realloc(void* p, size_t n) {
  ++allocations;
  return __libc_realloc(p, n);
}
void* memalign(size_t alignment, size_t n) {
  ++allocations;
  return __libc_memalign(alignment, n);
}
void* aligned_alloc(size_t alignment, size_t n) { return memalign(alignment, n); }
int posix_memalign(void** p, size_t alignment, size_t n) { return (*p = memalign(alignment, n)) ? 0 : 12; }
}

namespace {

void log(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String message, ...) {
  std::fprintf(stderr, "%s\n", message);
}

template <class Function>
Function* load(void* library, const char* name) {
  return reinterpret_cast<Function*>(dlsym(library, name));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 6) return 2;
  void* library = dlopen(argv[1], RTLD_NOW);
  if (!library) return 3;
  const double step = std::atof(argv[4]);
  const fmi2CallbackFunctions callbacks{log, nullptr, nullptr, nullptr, nullptr};

  long before = allocations;
  fmi2Component c =
      load<fmi2InstantiateTYPE>(library, "fmi2Instantiate")("p", fmi2CoSimulation, argv[2], argv[3], &callbacks, 0, 0);
  const long in_instantiate = allocations - before;
  if (!c) return 4;
  for (int i = 6; i < argc; ++i) {
    char type;
    unsigned vr;
    double real;
    if (std::sscanf(argv[i], "%c%u=%lf", &type, &vr, &real) != 3) return 2;
    const int integer = static_cast<int>(real);
    const fmi2Status status = type == 'r' ? load<fmi2SetRealTYPE>(library, "fmi2SetReal")(c, &vr, 1, &real)
                                          : load<fmi2SetIntegerTYPE>(library, "fmi2SetInteger")(c, &vr, 1, &integer);
    if (status != fmi2OK) return 5;
  }
  load<fmi2SetupExperimentTYPE>(library, "fmi2SetupExperiment")(c, 0, 0, 0, 0, 0);
  load<fmi2EnterInitializationModeTYPE>(library, "fmi2EnterInitializationMode")(c);
  if (load<fmi2ExitInitializationModeTYPE>(library, "fmi2ExitInitializationMode")(c) != fmi2OK) return 6;

  auto* do_step = load<fmi2DoStepTYPE>(library, "fmi2DoStep");
  long in_steps = 0;
  for (int i = 0; i < std::atoi(argv[5]); ++i) {
    before = allocations;
    const fmi2Status status = do_step(c, i * step, step, fmi2True);
    in_steps += allocations - before;
    if (status != fmi2OK) return 7;
  }
  load<fmi2FreeInstanceTYPE>(library, "fmi2FreeInstance")(c);
  std::printf("%ld %ld\n", in_steps, in_instantiate);
}
