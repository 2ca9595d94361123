/* Steps an FMU's library through recorded inputs and writes its outputs' bits.
 * Arguments: library, GUID, inputs file, outputs file, steps, first input, inputs, outputs;
 * the value references of the outputs follow those of the inputs. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#if defined(_WIN32)
#include <windows.h>
#define OPEN(path) ((void *)LoadLibraryA(path))
#define SYMBOL(library, name) ((void *)GetProcAddress((HMODULE)(library), name))
#else
#include <dlfcn.h>
#define OPEN(path) dlopen(path, RTLD_NOW)
#define SYMBOL(library, name) dlsym(library, name)
#endif

enum { CO_SIMULATION = 1, STEP_FAILED = 2 };

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

#define CALL(name, types, ...)                                     \
    do {                                                           \
        int(*f) types = (int(*) types)SYMBOL(library, "fmi2" name); \
        if (!f || f(__VA_ARGS__)) {                                \
            fprintf(stderr, "fmi2" name " failed\n");              \
            return STEP_FAILED;                                    \
        }                                                          \
    } while (0)

int main(int count, char **argument) {
    if (count != 9) return 1;
    const char *guid = argument[2];
    int steps = atoi(argument[5]), first = atoi(argument[6]);
    int inputs = atoi(argument[7]), outputs = atoi(argument[8]);
    void *library = OPEN(argument[1]);
    FILE *in = fopen(argument[3], "rb"), *out = fopen(argument[4], "wb");
    if (!library || !in || !out) return 1;
    void *(*instantiate)(const char *, int, const char *, const char *, const Callbacks *, int, int) =
        (void *(*)(const char *, int, const char *, const char *, const Callbacks *, int, int))SYMBOL(
            library, "fmi2Instantiate");
    Callbacks callbacks = {say, calloc, free, 0, 0};
    void *c = instantiate ? instantiate("host", CO_SIMULATION, guid, "", &callbacks, 0, 0) : 0;
    if (!c) return 1;
    CALL("SetupExperiment", (void *, int, double, double, int, double), c, 0, 0.0, 0.0, 0, 0.0);
    CALL("EnterInitializationMode", (void *), c);
    CALL("ExitInitializationMode", (void *), c);
    unsigned *reference = malloc(sizeof(unsigned) * (size_t)(inputs + outputs));
    double *value = malloc(sizeof(double) * (size_t)(inputs + outputs));
    for (int i = 0; i < inputs + outputs; i++) reference[i] = (unsigned)(first + i);
    for (int n = 0; n < steps; n++) {
        if (fread(value, sizeof(double), (size_t)inputs, in) != (size_t)inputs) return 1;
        CALL("SetReal", (void *, const unsigned *, size_t, const double *), c, reference,
             (size_t)inputs, value);
        CALL("DoStep", (void *, double, double, int), c, n * 1e-3, 1e-3, 1);
        CALL("GetReal", (void *, const unsigned *, size_t, double *), c, reference + inputs,
             (size_t)outputs, value);
        fwrite(value, sizeof(double), (size_t)outputs, out);
    }
    fclose(out);
    return 0;
}
