/* Steps FMUs one after the other through recorded inputs and writes their outputs' bits. Ten arguments
 * for each: library, or "-" if it is linked into this program; prefix of its functions' names, up to
 * fmi2 or fmi3; GUID; files of the inputs, of the value references of inputs and outputs, and for the
 * outputs; steps; numbers of inputs, outputs, and outputs' values. */
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if defined(_WIN32)
#include <windows.h>
#define OPEN(path) ((void *)LoadLibraryA(path))
#define SYMBOL(library, name) ((void *)GetProcAddress((HMODULE)(library), name))
#else
#include <dlfcn.h>
#define OPEN(path) dlopen(path, RTLD_NOW)
#define SYMBOL(library, name) dlsym(library, name)
#endif

enum { ARGUMENTS = 10, CO_SIMULATION = 1, STEP_FAILED = 2 };
static const double STEP = 1e-3;

typedef struct {
    void *library;
    const char *prefix;
    int version;
    void *c;
} Fmu;

typedef struct {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, int);
    void *environment;
} Callbacks;

static void say(void *environment, const char *name, int status, const char *category,
                const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
}

static void say3(void *environment, int status, const char *category, const char *message) {
    fprintf(stderr, "%s\n", message);
}

static void *function(const Fmu *fmu, const char *name) {
    char full[100];
    snprintf(full, sizeof full, "%s%s", fmu->prefix, name);
    void *found = SYMBOL(fmu->library, full);
    if (!found) fprintf(stderr, "there is no %s\n", full);
    return found;
}

#define CALL(name, types, ...)                             \
    do {                                                   \
        int(*f) types = (int(*) types)function(fmu, name); \
        if (!f || f(__VA_ARGS__)) {                        \
            fprintf(stderr, "%s failed\n", name);          \
            return STEP_FAILED;                            \
        }                                                  \
    } while (0)

typedef void *Instantiate2(const char *, int, const char *, const char *, const Callbacks *, int, int);
typedef void *Instantiate3(const char *, const char *, const char *, bool, bool, bool, bool,
                           const unsigned *, size_t, void *,
                           void (*)(void *, int, const char *, const char *), void *);

static int initialize(Fmu *fmu, const char *guid) {
    static const Callbacks callbacks = {say, calloc, free, 0, 0};
    const char *resources = getenv("FMU_RESOURCES") ? getenv("FMU_RESOURCES") : "";
    if (fmu->version == 2) {
        Instantiate2 *instantiate = (Instantiate2 *)function(fmu, "Instantiate");
        fmu->c = instantiate ? instantiate("host", CO_SIMULATION, guid, resources, &callbacks, 0, 0) : 0;
        if (!fmu->c) return 1;
        CALL("SetupExperiment", (void *, int, double, double, int, double), fmu->c, 0, 0.0, 0.0, 0, 0.0);
        CALL("EnterInitializationMode", (void *), fmu->c);
    } else {
        Instantiate3 *instantiate = (Instantiate3 *)function(fmu, "InstantiateCoSimulation");
        fmu->c = instantiate ? instantiate("host", guid, resources, 0, 0, 0, 0, 0, 0, 0, say3, 0) : 0;
        if (!fmu->c) return 1;
        CALL("EnterInitializationMode", (void *, bool, double, double, bool, double), fmu->c, 0, 0.0, 0.0, 0, 0.0);
    }
    CALL("ExitInitializationMode", (void *), fmu->c);
    return 0;
}

static int set(Fmu *fmu, const unsigned *reference, size_t count, const double *value) {
    if (fmu->version == 2)
        CALL("SetReal", (void *, const unsigned *, size_t, const double *), fmu->c, reference, count, value);
    else
        CALL("SetFloat64", (void *, const unsigned *, size_t, const double *, size_t), fmu->c, reference,
             count, value, count);
    return 0;
}

static int do_step(Fmu *fmu, double time) {
    bool event, end, early;
    double last;
    if (fmu->version == 2)
        CALL("DoStep", (void *, double, double, int), fmu->c, time, STEP, 1);
    else
        CALL("DoStep", (void *, double, double, bool, bool *, bool *, bool *, double *), fmu->c, time, STEP,
             1, &event, &end, &early, &last);
    return 0;
}

static int get(Fmu *fmu, const unsigned *reference, size_t count, double *value, size_t values) {
    if (fmu->version == 2)
        CALL("GetReal", (void *, const unsigned *, size_t, double *), fmu->c, reference, count, value);
    else
        CALL("GetFloat64", (void *, const unsigned *, size_t, double *, size_t), fmu->c, reference, count,
             value, values);
    return 0;
}

static int run(char **argument) {
    Fmu fmu = {0};
    fmu.library = OPEN(strcmp(argument[0], "-") == 0 ? NULL : argument[0]);
    fmu.prefix = argument[1];
    fmu.version = argument[1][strlen(argument[1]) - 1] - '0';
    FILE *in = fopen(argument[3], "rb"), *references = fopen(argument[4], "rb");
    FILE *out = fopen(argument[5], "wb");
    int steps = atoi(argument[6]);
    size_t inputs = (size_t)atoi(argument[7]), outputs = (size_t)atoi(argument[8]);
    size_t values = (size_t)atoi(argument[9]);
    if (!fmu.library || !in || !references || !out) return 1;
    unsigned *reference = malloc(sizeof(unsigned) * (inputs + outputs));
    double *value = malloc(sizeof(double) * (inputs + values));
    if (fread(reference, sizeof(unsigned), inputs + outputs, references) != inputs + outputs) return 1;
    if (initialize(&fmu, argument[2])) return 1;
    for (int n = 0; n < steps; n++) {
        if (fread(value, sizeof(double), inputs, in) != inputs) return 1;
        if (set(&fmu, reference, inputs, value) || do_step(&fmu, n * STEP) ||
            get(&fmu, reference + inputs, outputs, value, values))
            return STEP_FAILED;
        fwrite(value, sizeof(double), values, out);
    }
    fclose(out);
    return 0;
}

int main(int count, char **argument) {
    if ((count - 1) % ARGUMENTS) return 1;
    for (int n = 1; n < count; n += ARGUMENTS) {
        int failed = run(argument + n);
        if (failed) return failed;
    }
    return 0;
}
