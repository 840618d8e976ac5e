/* Runs one instance of an FMU's library on any platform and prints its outputs to the last bit.

     host LIBRARY GUID [RESOURCES] < calls

   One call a line; a Real is given and printed as the 16 hexadecimal digits of its bits:

     integer VR VALUE     fmi2SetInteger
     real VR BITS         fmi2SetReal
     initialize           fmi2SetupExperiment at 0 s to the end of Initialization Mode
     step BITS            fmi2DoStep over that many seconds
     print VR...          fmi2GetReal, on one line
*/
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2FunctionTypes.h"

#ifdef _WIN32
#include <windows.h>
static void* library_function(const char* library, const char* name) {
  return (void*)GetProcAddress(LoadLibraryA(library), name);
}
#else
#include <dlfcn.h>
static void* library_function(const char* library, const char* name) {
  void* handle = dlopen(library, RTLD_NOW | RTLD_LOCAL);
  if (!handle) fprintf(stderr, "%s\n", dlerror());
  return handle ? dlsym(handle, name) : NULL;
}
#endif

static void stop(const char* what) {
  fprintf(stderr, "host: %s\n", what);
  exit(1);
}

static void check(fmi2Status status, const char* what) {
  if (status > fmi2Warning) stop(what);
}

static void write_log(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status,
                      fmi2String category, fmi2String message, ...) {
  (void)environment, (void)status;
  fprintf(stderr, "%s, %s: %s\n", instance, category, message);
}

static double from_bits(const char* digits) {
  const uint64_t bits = strtoull(digits, NULL, 16);
  double value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

static void print_bits(double value) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  printf("%016" PRIx64 " ", bits);
}

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) stop("arguments: LIBRARY GUID [RESOURCES]");
#define FUNCTION(name)                                                            \
  fmi2##name##TYPE* name = (fmi2##name##TYPE*)library_function(argv[1], "fmi2" #name); \
  if (!name) stop("the library cannot be loaded or lacks fmi2" #name)
  FUNCTION(Instantiate);
  FUNCTION(SetupExperiment);
  FUNCTION(EnterInitializationMode);
  FUNCTION(ExitInitializationMode);
  FUNCTION(SetInteger);
  FUNCTION(SetReal);
  FUNCTION(GetReal);
  FUNCTION(DoStep);
  FUNCTION(Terminate);
  FUNCTION(FreeInstance);

  const fmi2CallbackFunctions callbacks = {write_log, calloc, free, NULL, NULL};
  fmi2Component fmu = Instantiate("host", fmi2CoSimulation, argv[2], argc > 3 ? argv[3] : NULL, &callbacks, fmi2False, fmi2False);
  if (!fmu) stop("fmi2Instantiate failed");

  double time = 0;
  char line[1000];
  while (fgets(line, sizeof line, stdin)) {
    const char* call = strtok(line, " \r\n");
    if (!call) continue;
    const char* first = strtok(NULL, " \r\n");
    if (!strcmp(call, "initialize")) {
      check(SetupExperiment(fmu, fmi2False, 0, 0, fmi2False, 0), call);
      check(EnterInitializationMode(fmu), call);
      check(ExitInitializationMode(fmu), call);
    } else if (!first) {
      stop("an argument is missing");
    } else if (!strcmp(call, "step")) {
      const double h = from_bits(first);
      check(DoStep(fmu, time, h, fmi2True), call);
      time += h;
    } else if (!strcmp(call, "print")) {
      for (const char* digits = first; digits; digits = strtok(NULL, " \r\n")) {
        const fmi2ValueReference reference = strtoul(digits, NULL, 10);
        double value;
        check(GetReal(fmu, &reference, 1, &value), call);
        print_bits(value);
      }
      printf("\n");
    } else {
      const fmi2ValueReference reference = strtoul(first, NULL, 10);
      const char* given = strtok(NULL, " \r\n");
      if (!given) {
        stop("a value is missing");
      } else if (!strcmp(call, "integer")) {
        const fmi2Integer value = atoi(given);
        check(SetInteger(fmu, &reference, 1, &value), call);
      } else if (!strcmp(call, "real")) {
        const double value = from_bits(given);
        check(SetReal(fmu, &reference, 1, &value), call);
      } else {
        stop("unknown call");
      }
    }
  }
  check(Terminate(fmu), "fmi2Terminate");
  FreeInstance(fmu);
  return 0;
}
