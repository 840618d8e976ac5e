/* A host in plain C: the pantograph under a wire that gives way, coupled implicitly.

     cc host.c -I<folder of the FMI 2.0 headers> -ldl -lm -o host
     unzip ZSpringPantograph.fmu -d pantograph
     ./host pantograph > result.csv

   The wire is a spring that a support moves: its height is z = path(t) + (F - F0) / k. In each communication step
   the height and the contact force at its end are made to agree by Newton's method: save the state, step, read the
   force and its derivative, go back, correct, repeat. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2FunctionTypes.h"

#ifdef _WIN32
#include <windows.h>
#define LIBRARY "binaries/win64/ZSpringPantograph.dll"
#define open_library(path) ((void *)LoadLibraryA(path))
#define find(library, name) ((void *)GetProcAddress((HMODULE)(library), name))
#else
#include <dlfcn.h>
#define open_library(path) dlopen(path, RTLD_NOW | RTLD_LOCAL)
#define find(library, name) dlsym(library, name)
#if defined(__APPLE__) && defined(__aarch64__)
#define LIBRARY "binaries/aarch64-darwin/ZSpringPantograph.dylib"
#elif defined(__APPLE__)
#define LIBRARY "binaries/darwin64/ZSpringPantograph.dylib"
#elif defined(__aarch64__)
#define LIBRARY "binaries/aarch64-linux/ZSpringPantograph.so"
#else
#define LIBRARY "binaries/linux64/ZSpringPantograph.so"
#endif
#endif

enum { WIRE = 3, STEPS = 1000 };
static const double H = 1e-3;   /* communication step, s */
static const double K = 3000;   /* stiffness of the wire, N/m */
static const double PI = 3.14159265358979323846;

static void fail(const char *what) {
  fprintf(stderr, "host: %s\n", what);
  exit(1);
}

static void check(fmi2Status status, const char *call) {
  if (status > fmi2Warning) fail(call); /* the FMU has logged why */
}

static void log_message(fmi2ComponentEnvironment e, fmi2String name, fmi2Status status, fmi2String category,
                        fmi2String message, ...) {
  va_list arguments;
  (void)e, (void)status;
  fprintf(stderr, "%s %s: ", name, category);
  va_start(arguments, message);
  vfprintf(stderr, message, arguments);
  va_end(arguments);
  fputc('\n', stderr);
}

/* The attribute that follows `before` in the model description, such as guid=" or name="m1" valueReference=" */
static void attribute(const char *xml, const char *before, char *value, size_t size) {
  const char *from = strstr(xml, before), *to;
  if (!from) fail(before);
  from += strlen(before);
  to = strchr(from, '"');
  if (!to || (size_t)(to - from) >= size) fail(before);
  memcpy(value, from, (size_t)(to - from));
  value[to - from] = '\0';
}

static fmi2ValueReference reference(const char *xml, const char *name) {
  char before[128], value[16];
  snprintf(before, sizeof before, "name=\"%s\" valueReference=\"", name);
  attribute(xml, before, value, sizeof value);
  return (fmi2ValueReference)strtoul(value, NULL, 10);
}

static char *read_file(const char *path) {
  FILE *file = fopen(path, "rb");
  char *text = calloc(1, 1 << 20);
  if (!file || !text || fread(text, 1, (1 << 20) - 1, file) == 0) fail(path);
  fclose(file);
  return text;
}

static double path_of_support(double t) {
  const double s = sin(2 * PI * t / 0.5); /* a span each 0.5 s, from rest */
  return 0.02 * s * s * s;
}

static void *function(void *library, const char *name) {
  void *found = find(library, name);
  if (!found) fail(name);
  return found;
}
#define LOAD(name) name##TYPE *name = (name##TYPE *)function(library, #name)

int main(int argc, char **argv) {
  char file[4096], guid[64];
  const char *folder = argc == 2 ? argv[1] : (fail("usage: host FOLDER, that of the unzipped FMU"), "");
  snprintf(file, sizeof file, "%s/modelDescription.xml", folder);
  char *xml = read_file(file);
  attribute(xml, "guid=\"", guid, sizeof guid);
  const fmi2ValueReference drive = reference(xml, "drive"), damping = reference(xml, "contact.c"),
                           wire_height = reference(xml, "wire_height"), contact = reference(xml, "contact.force");

  snprintf(file, sizeof file, "%s/%s", folder, LIBRARY);
  void *library = open_library(file);
  if (!library) fail(file);
  LOAD(fmi2Instantiate);
  LOAD(fmi2SetupExperiment);
  LOAD(fmi2EnterInitializationMode);
  LOAD(fmi2ExitInitializationMode);
  LOAD(fmi2SetInteger);
  LOAD(fmi2SetReal);
  LOAD(fmi2GetReal);
  LOAD(fmi2DoStep);
  LOAD(fmi2GetFMUstate);
  LOAD(fmi2SetFMUstate);
  LOAD(fmi2FreeFMUstate);
  LOAD(fmi2GetDirectionalDerivative);
  LOAD(fmi2Terminate);
  LOAD(fmi2FreeInstance);

  const fmi2CallbackFunctions callbacks = {log_message, calloc, free, NULL, NULL};
  fmi2Component pantograph =
      fmi2Instantiate("pantograph", fmi2CoSimulation, guid, "", &callbacks, fmi2False, fmi2False);
  if (!pantograph) fail("fmi2Instantiate");

  const fmi2Integer wire = WIRE;
  const double c = 50; /* N.s/m */
  check(fmi2SetInteger(pantograph, &drive, 1, &wire), "fmi2SetInteger");
  check(fmi2SetReal(pantograph, &damping, 1, &c), "fmi2SetReal");
  check(fmi2SetupExperiment(pantograph, fmi2False, 0, 0, fmi2False, 0), "fmi2SetupExperiment");
  check(fmi2EnterInitializationMode(pantograph), "fmi2EnterInitializationMode");
  check(fmi2ExitInitializationMode(pantograph), "fmi2ExitInitializationMode");

  double z = 0, F, F0;
  check(fmi2GetReal(pantograph, &contact, 1, &F0), "fmi2GetReal");
  fmi2FMUstate before = NULL; /* the FMU fills the same memory anew each step */
  printf("time [s],wire_height [m],contact.force [N],iterations\n");
  for (int n = 0; n < STEPS; ++n) {
    int iteration = 0;
    check(fmi2GetFMUstate(pantograph, &before), "fmi2GetFMUstate");
    for (;;) {
      const double one = 1;
      double slope; /* dF/dz, exact for this step */
      check(fmi2SetReal(pantograph, &wire_height, 1, &z), "fmi2SetReal");
      check(fmi2DoStep(pantograph, n * H, H, fmi2False), "fmi2DoStep");
      check(fmi2GetReal(pantograph, &contact, 1, &F), "fmi2GetReal");
      const double residual = z - (path_of_support((n + 1) * H) + (F - F0) / K);
      if (fabs(residual) < 1e-9 || ++iteration > 50) break;
      check(fmi2GetDirectionalDerivative(pantograph, &contact, 1, &wire_height, 1, &one, &slope), "derivative");
      z -= residual / (1 - slope / K);
      check(fmi2SetFMUstate(pantograph, before), "fmi2SetFMUstate");
    }
    printf("%.17g,%.17g,%.17g,%d\n", (n + 1) * H, z, F, iteration);
  }
  check(fmi2FreeFMUstate(pantograph, &before), "fmi2FreeFMUstate");
  check(fmi2Terminate(pantograph), "fmi2Terminate");
  fmi2FreeInstance(pantograph);
  free(xml);
  return 0;
}
