/* Times one block: the generated step alone, and the steps of its FMI 2.0 and FMI 3.0 libraries.
 * Arguments: FMI 2.0 library, FMI 3.0 library, GUID of each, step size [s], parameter to set.
 * Prints the nanoseconds that each library took from its opening to an instance, then for each round
 * those of an addition, a multiplication, a division, a choice (smaller, larger, absolute) and a root,
 * and those of a step: bare, fmi2, fmi3, both with inputs set and outputs read, and fmi2 with a tunable parameter set (0 where there is none). */
#define _POSIX_C_SOURCE 199309L
#include <dlfcn.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core.h"

#define CASADI_SYMBOL_EXPORT static
#include "equations.h"

enum { ROUNDS = 60, STEPS = 2000 };

static double size;

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

static void silent(void *environment, ...) { (void)environment; }

typedef struct {
    void *logger, *allocate, *release, *finished, *environment;
} Callbacks;

static void *library[2], *instance[2];
static double u[N_INPUTS + 1], y[N_OUTPUTS + 1];
static unsigned input[N_INPUTS + 1], output[N_OUTPUTS + 1];
static size_t readable; /* of those that are scalars in both versions */

#define FUNCTION(version, name, result, ...) \
    result (*name)(__VA_ARGS__) = (result(*)(__VA_ARGS__))dlsym(library[version], #name)
#define MUST(call) \
    if (call) exit(2)

static void open_fmi2(const char *path, const char *guid) {
    library[0] = dlopen(path, RTLD_NOW);
    FUNCTION(0, fmi2Instantiate, void *, const char *, int, const char *, const char *, void *, int, int);
    FUNCTION(0, fmi2EnterInitializationMode, int, void *);
    FUNCTION(0, fmi2ExitInitializationMode, int, void *);
    static Callbacks callbacks = {(void *)silent, (void *)calloc, (void *)free, 0, 0};
    instance[0] = fmi2Instantiate("two", 1, guid, "", &callbacks, 0, 0);
    MUST(!instance[0] || fmi2EnterInitializationMode(instance[0]) || fmi2ExitInitializationMode(instance[0]));
}

static void open_fmi3(const char *path, const char *guid) {
    library[1] = dlopen(path, RTLD_NOW);
    FUNCTION(1, fmi3InstantiateCoSimulation, void *, const char *, const char *, const char *, bool, bool,
             bool, bool, const unsigned *, size_t, void *, void *, void *);
    FUNCTION(1, fmi3EnterInitializationMode, int, void *, bool, double, double, bool, double);
    FUNCTION(1, fmi3ExitInitializationMode, int, void *);
    instance[1] = fmi3InstantiateCoSimulation("three", guid, "", 0, 0, 0, 0, 0, 0, 0, 0, 0);
    MUST(!instance[1] || fmi3EnterInitializationMode(instance[1], 0, 0, 0, 0, 0) ||
         fmi3ExitInitializationMode(instance[1]));
}

static double bare(void) {
    static double x[2][N_STATES + 1], rate[N_INPUTS + 1], d[N_DERIVED + 1], p[N_PARAMETERS + 1],
        ends[2][N_INPUTS + 1], w[WORK_W + 1], t[N_TRANSITION + 1];
    static const double *arg[WORK_ARG + 1];
    static double *res[WORK_RES + 1];
    static long long iw[WORK_IW + 1];
    double margin;
    for (int i = 0; i < N_PARAMETERS; i++) p[i] = VARIABLE_INFO[i].start;
    arg[0] = p, res[0] = d;
    derived(arg, res, iw, w, 0);
    arg[0] = p, arg[1] = d, arg[2] = u, res[0] = x[0];
    initial(arg, res, iw, w, 0);
#if N_TRANSITION
    arg[0] = d, arg[1] = &size, res[0] = t;
    transition(arg, res, iw, w, 0);
#endif
    memcpy(ends[0], u, sizeof u);
    /* Else the compiler would take what it knows of this host's numbers out of the equations. */
    int (*volatile generated)(const double **, double **, long long *, double *, int) = step;
    double start = now();
    for (int k = 0; k < STEPS; k++) {
        arg[0] = x[k % 2], arg[1] = ends[k % 2], arg[2] = rate, arg[3] = p, arg[4] = d, arg[5] = &size, arg[6] = t;
        res[0] = x[(k + 1) % 2], res[1] = ends[(k + 1) % 2], res[2] = &margin;
        generated(arg, res, iw, w, 0);
    }
    return (now() - start) / STEPS;
}

#ifdef __aarch64__
#define IN_REGISTER "+w"
#else
#define IN_REGISTER "+x"
#endif
/* Nanoseconds of one operation, where eight at a time wait for none of the others. */
#define COST(name, operation)                                                     \
    static double name(void) {                                                    \
        double a[8], y = 1.0 + 1e-30 * now();                              \
        for (int i = 0; i < 8; i++) a[i] = 1.0 + i;                               \
        double start = now();                                                     \
        for (int k = 0; k < STEPS; k++) {                                         \
            for (int i = 0; i < 8; i++) {                                         \
                double x = a[i];                                                  \
                a[i] = operation;                                                 \
                __asm__ volatile("" : IN_REGISTER(a[i]));                         \
            }                                                                     \
        }                                                                         \
        return (now() - start) / STEPS / 8;                                       \
    }
COST(cost_add, x + y)
COST(cost_multiply, x * y)
COST(cost_divide, x / y)
COST(cost_choose, x < y ? x : y)
COST(cost_root, __builtin_sqrt(x))

/* exchange: with inputs set and outputs read; parameter: set in each step, 0 for none. */
static double fmi2(bool exchange, unsigned parameter) {
    FUNCTION(0, fmi2SetReal, int, void *, const unsigned *, size_t, const double *);
    FUNCTION(0, fmi2GetReal, int, void *, const unsigned *, size_t, double *);
    FUNCTION(0, fmi2DoStep, int, void *, double, double, int);
    double value = 0.0, start = now();
    if (parameter) MUST(fmi2GetReal(instance[0], &parameter, 1, &value));
    for (int k = 0; k < STEPS; k++) {
        if (exchange) MUST(fmi2SetReal(instance[0], input, N_INPUTS, u));
        if (parameter) MUST(fmi2SetReal(instance[0], &parameter, 1, &value));
        MUST(fmi2DoStep(instance[0], k * size, size, 1));
        if (exchange) MUST(fmi2GetReal(instance[0], output, readable, y));
    }
    return (now() - start) / STEPS;
}

static double fmi3(bool exchange) {
    FUNCTION(1, fmi3SetFloat64, int, void *, const unsigned *, size_t, const double *, size_t);
    FUNCTION(1, fmi3GetFloat64, int, void *, const unsigned *, size_t, double *, size_t);
    FUNCTION(1, fmi3DoStep, int, void *, double, double, bool, bool *, bool *, bool *, double *);
    bool event, end, early;
    double last, start = now();
    for (int k = 0; k < STEPS; k++) {
        if (exchange) MUST(fmi3SetFloat64(instance[1], input, N_INPUTS, u, N_INPUTS));
        MUST(fmi3DoStep(instance[1], k * size, size, 1, &event, &end, &early, &last));
        if (exchange) MUST(fmi3GetFloat64(instance[1], output, readable, y, readable));
    }
    return (now() - start) / STEPS;
}

int main(int count, char **argument) {
    if (count != 7) return 1;
    size = atof(argument[5]);
    double start = now();
    open_fmi2(argument[1], argument[3]);
    double middle = now();
    open_fmi3(argument[2], argument[4]);
    printf("%g %g\n", middle - start, now() - middle);
    FUNCTION(1, fmi3GetFloat64, int, void *, const unsigned *, size_t, double *, size_t);
    for (unsigned i = 0; i < N_INPUTS; i++) {
        input[i] = FIRST_INPUT + i;
        u[i] = VARIABLE_INFO[FIRST_INPUT - 1 + i].start;
    }
    for (unsigned i = FIRST_OUTPUT; i < FIRST_LOCAL; i++)
        if (fmi3GetFloat64(instance[1], &i, 1, y, 1) == 0) output[readable++] = i;
    for (int round = 0; round < ROUNDS; round++) {
        printf("%g %g %g %g %g ", cost_add(), cost_multiply(), cost_divide(), cost_choose(), cost_root());
        printf("%g %g %g %g %g %g\n", bare(), fmi2(false, 0), fmi3(false), fmi2(true, 0), fmi3(true),
               fmi2(false, (unsigned)atoi(argument[6])));
    }
    return 0;
}
