/* Times one block: the generated step alone, and the steps of its FMI 2.0 and FMI 3.0 libraries.
 * Arguments: FMI 2.0 library, FMI 3.0 library, GUID of each, step size [s], parameter to set.
 * Prints the nanoseconds that each library took from its opening to an instance, then for each round
 * those of a step: all equations alone, the step's alone, fmi2, fmi3, both with inputs set and outputs
 * read, fmi2 with a tunable parameter set (0 where there is none), and the calls of an FMU without
 * equations. */
#define _POSIX_C_SOURCE 199309L
#include <dlfcn.h>
#include <math.h>
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
static double u[2][N_INPUTS + 1], y[N_OUTPUTS + 1]; /* the inputs of even and of odd steps */
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

/* The generated equations without an FMU around them. */
static struct {
    double x[2][N_STATES + 1], u[2][N_INPUTS + 1], rate[N_INPUTS + 1], y[N_OUTPUTS + 1], p[N_PARAMETERS + 1];
    double d[N_DERIVED + 1], t[N_TRANSITION + 1], w[WORK_W + 1], margin, number;
    double lookup[TABLE_ROWS * TABLE_STATIONS + 1], station[TABLE_STATIONS + 1];
    double page[TABLE_SLOTS][TABLE_PAGE_SIZE + 1];
    int64_t filled[TABLE_SLOTS]; /* number of the page in a slot, from 1 */
    const double *arg[WORK_ARG + 1];
    double *res[WORK_RES + 1];
    long long iw[WORK_IW + 1];
} e;

/* Through a volatile pointer: else the compiler would take what it knows of these numbers out of the equations. */
#define CALL(function)                                                                                     \
    do {                                                                                                   \
        int (*volatile generated)(const double **, double **, long long *, double *, int) = function;      \
        generated(e.arg, e.res, e.iw, e.w, 0);                                                             \
    } while (0)

static void begin(void) {
    for (int i = 0; i < N_PARAMETERS; i++) e.p[i] = VARIABLE_INFO[i].start;
    memset(e.filled, 0, sizeof e.filled);
    e.arg[0] = e.p, e.res[0] = e.d;
    CALL(derived);
    e.arg[0] = e.p, e.arg[1] = e.d, e.arg[2] = u[0], e.res[0] = e.x[0];
    CALL(initial);
#if N_TRANSITION
    e.arg[0] = e.d, e.arg[1] = &size, e.res[0] = e.t;
    CALL(transition);
#endif
    memcpy(e.u[0], u[0], sizeof u[0]);
}

/* A micro step number k from these inputs. */
static void step_alone(int k, const double *from) {
    e.arg[0] = e.x[k % 2], e.arg[1] = from, e.arg[2] = e.rate, e.arg[3] = e.p, e.arg[4] = e.d, e.arg[5] = &size;
    e.arg[6] = e.t;
    e.res[0] = e.x[(k + 1) % 2], e.res[1] = e.u[(k + 1) % 2], e.res[2] = &e.margin;
    CALL(step);
#if HAS_MARGIN
    if (e.margin < 0.0) CALL(step_beyond);
#endif
}

#if TABLE_STATIONS
static const double *node_of(double node) {
    e.number = floor(node / TABLE_NODES);
    int64_t number = (int64_t)e.number, slot = ((number % TABLE_SLOTS) + TABLE_SLOTS) % TABLE_SLOTS;
    if (e.filled[slot] != number + 1) {
        e.arg[0] = &e.number, e.arg[1] = e.d, e.res[0] = e.page[slot];
        CALL(page);
        e.filled[slot] = number + 1;
    }
    return e.page[slot] + (int64_t)(node - e.number * TABLE_NODES) * TABLE_VALUES;
}

static void look_up(void) {
    e.res[0] = e.station;
    CALL(stations);
    for (int i = 0; i < TABLE_STATIONS; i++) {
        double place = e.station[i] / TABLE_SPACING, node = floor(place), *column = e.lookup + i * TABLE_ROWS;
        column[0] = place - node;
        memcpy(column + 1, node_of(node), TABLE_VALUES * sizeof(double));
        memcpy(column + 1 + TABLE_VALUES, node_of(node + 1.0), TABLE_VALUES * sizeof(double));
    }
}
#endif

static void at_end(int k) {
    e.arg[0] = e.x[(k + 1) % 2], e.arg[1] = e.u[(k + 1) % 2], e.arg[2] = e.p, e.arg[3] = e.d;
}

static double bare(void) {
    begin();
    double start = now();
    for (int k = 0; k < STEPS; k++) step_alone(k, e.u[k % 2]);
    return (now() - start) / STEPS;
}

/* All equations that a doStep needs and the outputs behind it, called one after the other. */
static double equations(void) {
    begin();
    double largest, start = now();
    for (int k = 0; k < STEPS; k++) {
        e.arg[0] = e.x[k % 2], e.arg[1] = u[k % 2], e.arg[2] = e.p, e.arg[3] = e.d, e.res[0] = &largest;
        CALL(largest_step);
        step_alone(k, u[k % 2]);
        at_end(k);
#if TABLE_STATIONS
        look_up();
        at_end(k);
#endif
        e.arg[4] = e.lookup, e.res[0] = e.y, e.res[1] = &e.margin;
        CALL(outputs);
#if HAS_MARGIN
        if (e.margin < 0.0) CALL(outputs_beyond);
#endif
    }
    return (now() - start) / STEPS;
}

/* An FMU without equations: numbers by their value references, and calls. */
static double kept[FIRST_LOCAL + 1];

static int keep(void *instance, const unsigned *reference, size_t count, const double *value) {
    for (size_t i = 0; i < count; i++) {
        if (reference[i] >= FIRST_LOCAL) return 3;
        kept[reference[i]] = value[i];
    }
    return 0;
}

static int pass(void *instance, double time, double step, int new) { return !(step > 0.0 && time >= 0.0); }

static int give(void *instance, const unsigned *reference, size_t count, double *value) {
    for (size_t i = 0; i < count; i++) {
        if (reference[i] >= FIRST_LOCAL) return 3;
        value[i] = kept[reference[i]];
    }
    return 0;
}

static double calls(void) {
    int (*volatile set)(void *, const unsigned *, size_t, const double *) = keep;
    int (*volatile step)(void *, double, double, int) = pass;
    int (*volatile get)(void *, const unsigned *, size_t, double *) = give;
    double start = now();
    for (int k = 0; k < STEPS; k++) {
        MUST(set(instance[0], input, N_INPUTS, u[k % 2]));
        MUST(step(instance[0], k * size, size, 1));
        MUST(get(instance[0], output, readable, y));
    }
    return (now() - start) / STEPS;
}

/* exchange: with inputs set and outputs read; parameter: set in each step, 0 for none. */
static double fmi2(bool exchange, unsigned parameter) {
    FUNCTION(0, fmi2SetReal, int, void *, const unsigned *, size_t, const double *);
    FUNCTION(0, fmi2GetReal, int, void *, const unsigned *, size_t, double *);
    FUNCTION(0, fmi2DoStep, int, void *, double, double, int);
    double value = 0.0, start = now();
    if (parameter) MUST(fmi2GetReal(instance[0], &parameter, 1, &value));
    for (int k = 0; k < STEPS; k++) {
        if (exchange) MUST(fmi2SetReal(instance[0], input, N_INPUTS, u[k % 2]));
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
        if (exchange) MUST(fmi3SetFloat64(instance[1], input, N_INPUTS, u[k % 2], N_INPUTS));
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
        u[0][i] = VARIABLE_INFO[FIRST_INPUT - 1 + i].start;
        u[1][i] = 1.001 * u[0][i] + 1e-7;
    }
    for (unsigned i = FIRST_OUTPUT; i < FIRST_LOCAL; i++)
        if (fmi3GetFloat64(instance[1], &i, 1, y, 1) == 0) output[readable++] = i;
    for (int round = 0; round < ROUNDS; round++) {
        printf("%g %g %g %g %g %g %g %g\n", equations(), bare(), fmi2(false, 0), fmi3(false), fmi2(true, 0), fmi3(true),
               fmi2(false, (unsigned)atoi(argument[6])), calls());
    }
    return 0;
}
