/* What calls the generated equations: derived constants, states, outputs, steps, derivatives. */
#include "evaluate.h"

#include <math.h>
#include <string.h>

#define CASADI_SYMBOL_EXPORT static
#define CASADI_CODEGEN_PREFIX
#define CODEGEN_PREFIX INTERNAL(equations_)
#include "equations.h"

static double *parameters(State *s) { return s->value + FIRST_PARAMETER; }
static double *inputs(State *s) { return s->value + FIRST_INPUT; }
static double *outputs_of(State *s) { return s->value + FIRST_OUTPUT; }

const char *first_lost(const double *x, const double *u) {
    if (all_finite(x, N_STATES) && all_finite(u, N_INPUTS)) return NULL;
    for (int i = 0; i < N_STATES; i++)
        if (!finite_number(x[i])) return STATE_NAME[i];
    for (int i = 0; i < N_INPUTS; i++)
        if (!finite_number(u[i])) return VARIABLE_INFO[FIRST_INPUT - 1 + i].name;
    return NULL;
}

/* The arguments and results of a generated function, which has room behind them for those that it
 * calls in turn. Where the compiler puts a function in place, they are gone. */
#define LISTS                         \
    const double *arg[WORK_ARG + 1]; \
    double *res[WORK_RES + 1]
#define CALL(function) function(arg, res, instance->iw, instance->w, 0)

/* The arguments (x, u, p, d) that most functions begin with. */
static inline void common_arguments(const double **arg, State *s) {
    arg[0] = s->x;
    arg[1] = inputs(s);
    arg[2] = parameters(s);
    arg[3] = s->d;
}

void forget_caches(Instance *instance) {
    memset(instance->page_filled, 0, sizeof instance->page_filled);
    instance->transition_size = -1.0;
}

void release_equations(Instance *instance) { (void)instance; }

static Status refresh_derived(Instance *instance) {
    State *s = &instance->state;
    if (!s->derived_stale) return OK;
    LISTS;
    arg[0] = parameters(s);
    res[0] = s->d;
    CALL(derived);
    if (!all_finite(s->d, N_DERIVED))
        return core_fail(instance, "these parameter values give no finite model; check for zero or "
                                   "contradicting masses, lengths and stiffnesses");
    s->derived_stale = 0;
    forget_caches(instance);
    return OK;
}

Status refresh_states(Instance *instance) {
    State *s = &instance->state;
    if (refresh_derived(instance) != OK) return ERROR;
    if (!s->states_stale) return OK;
    LISTS;
    arg[0] = parameters(s);
    arg[1] = s->d;
    arg[2] = inputs(s);
    res[0] = s->x;
    CALL(initial);
    s->states_stale = 0;
    return OK;
}

/* The same where nothing is stale most of the time. */
static inline Status with_states(Instance *instance) {
    const State *s = &instance->state;
    return s->derived_stale | s->states_stale ? refresh_states(instance) : OK;
}

#if TABLE_STATIONS
/* A table can be asked for any station; beyond this many pages the number would lose digits. */
static const double FARTHEST_PAGE = 1e12;

static const double *table_node(Instance *instance, double node) {
    double number = floor(node / TABLE_NODES);
    int64_t wanted = (int64_t)number;
    int slot = (int)(((wanted % TABLE_SLOTS) + TABLE_SLOTS) % TABLE_SLOTS);
    if (!instance->page_filled[slot] || instance->page_number[slot] != wanted) {
        LISTS;
        arg[0] = &number;
        arg[1] = instance->state.d;
        res[0] = instance->page[slot];
        CALL(page);
        instance->page_number[slot] = wanted;
        instance->page_filled[slot] = 1;
    }
    return instance->page[slot] + (int64_t)(node - number * TABLE_NODES) * TABLE_VALUES;
}

static Status refresh_lookup(Instance *instance) {
    State *s = &instance->state;
    double station[TABLE_STATIONS];
    LISTS;
    common_arguments(arg, s);
    res[0] = station;
    CALL(stations);
    for (int i = 0; i < TABLE_STATIONS; i++) {
        double place = station[i] / TABLE_SPACING, node = floor(place);
        double *column = instance->lookup + i * TABLE_ROWS;
        if (!(fabs(node) < FARTHEST_PAGE * TABLE_NODES))
            return core_fail(instance, "station %g is beyond what the table can address", station[i]);
        column[0] = place - node;
        memcpy(column + 1, table_node(instance, node), TABLE_VALUES * sizeof(double));
        memcpy(column + 1 + TABLE_VALUES, table_node(instance, node + 1.0),
               TABLE_VALUES * sizeof(double));
    }
    return OK;
}
#else
static Status refresh_lookup(Instance *instance) {
    (void)instance;
    return OK;
}
#endif

Status refresh_outputs(Instance *instance) {
    State *s = &instance->state;
    if (!s->outputs_stale) return OK;
    if (with_states(instance) != OK || refresh_lookup(instance) != OK) return ERROR;
    LISTS;
    common_arguments(arg, s);
    arg[4] = instance->lookup;
    res[0] = outputs_of(s);
#if HAS_MARGIN
    double margin;
    res[1] = &margin;
    CALL(outputs);
    if (margin < 0.0) CALL(outputs_beyond);
#else
    CALL(outputs);
#endif
    s->outputs_stale = 0;
    return OK;
}

Status evaluate_derivatives(Instance *instance, double *rate) {
    if (refresh_states(instance) != OK) return ERROR;
#if N_CONTINUOUS
    LISTS;
    common_arguments(arg, &instance->state);
    res[0] = rate;
    CALL(derivative);
    for (int i = 0; i < N_CONTINUOUS; i++)
        if (!finite_number(rate[i]))
            return core_fail(instance, "the time derivative of %s is not finite", STATE_NAME[i]);
#endif
    return OK;
}

Status evaluate_indicators(Instance *instance, double *indicator) {
    if (refresh_states(instance) != OK) return ERROR;
#if N_INDICATORS
    LISTS;
    common_arguments(arg, &instance->state);
    arg[4] = instance->state.mode;
    res[0] = indicator;
    CALL(event_indicators);
#endif
    return OK;
}

Status evaluate_constants(Instance *instance, double *constant) {
    if (refresh_derived(instance) != OK) return ERROR;
#if N_CONSTANTS
    LISTS;
    arg[0] = parameters(&instance->state);
    arg[1] = instance->state.d;
    res[0] = constant;
    CALL(constants);
#endif
    return OK;
}

Status update_memory(Instance *instance) {
    if (refresh_states(instance) != OK) return ERROR;
#if N_MEMORY
    State *s = &instance->state;
    double memory[N_MEMORY], mode[N_MODES + 1];
    LISTS;
    common_arguments(arg, s);
    arg[4] = s->mode;
    res[0] = memory;
    res[1] = mode;
    CALL(memory_after);
    for (int i = 0; i < N_MEMORY; i++)
        if (!finite_number(memory[i]))
            return core_fail(instance, "%s is no longer finite at t = %.17g s", STATE_NAME[N_CONTINUOUS + i], s->time);
    memcpy(s->x + N_CONTINUOUS, memory, sizeof memory);
    memcpy(s->mode, mode, N_MODES * sizeof *mode);
    s->outputs_stale = s->slopes_stale = 1;
#endif
    return OK;
}

/* A step of this many micro steps takes about a second; more are a mistake in the step or the parameters. */
static const double MOST_MICRO_STEPS = 1e6;

static inline Status plan(Instance *instance, double time, double size, long *count) {
    State *s = &instance->state;
    if (instance->interface != CO_SIMULATION)
        return core_fail(instance, "doStep is for co-simulation, and this instance for model exchange");
    if (s->phase != STEPPING)
        return core_fail(instance, "doStep needs a finished initialization and no termination");
    if (!(size >= 0.0) || !finite_number(time + size))
        return core_fail(instance, "doStep from t = %g s by %g s: the step must be finite and not negative",
                         time, size);
    if (with_states(instance) != OK) return ERROR;
    double largest = size;
    LISTS;
    common_arguments(arg, s);
    res[0] = &largest;
    CALL(largest_step);
    *count = 1;
    if (size <= largest) return OK;
    double steps = ceil(size / largest - 1e-9);
    if (!(steps <= MOST_MICRO_STEPS))
        return core_fail(instance, "doStep by %g s would take %g micro steps of %g s, and %g are the most: take "
                                   "shorter steps, or correct the parameters that make micro steps so short",
                         size, steps, largest, MOST_MICRO_STEPS);
    if (steps > 1.0) *count = (long)steps;
    return OK;
}

static inline void refresh_transition(Instance *instance, double micro) {
#if N_TRANSITION
    if (micro == instance->transition_size) return;
    LISTS;
    arg[0] = instance->state.d;
    arg[1] = &micro;
    res[0] = instance->transition;
    CALL(transition);
    instance->transition_size = micro;
#else
    (void)instance;
    (void)micro;
#endif
}

static inline Status advance(Instance *instance, double time, double size, long count) {
    State *s = &instance->state;
    double ends[2][N_STATES + N_INPUTS + 1], micro = size / (double)count;
    const double *x = s->x, *u = inputs(s);
    LISTS;
    refresh_transition(instance, micro);
    for (long i = 0; i < count; i++) {
        double *end = ends[i % 2];
        arg[0] = x;
        arg[1] = u;
        arg[2] = s->rate;
        arg[3] = parameters(s);
        arg[4] = s->d;
        arg[5] = &micro;
        arg[6] = instance->transition;
        res[0] = end;
        res[1] = end + N_STATES;
#if HAS_MARGIN
        double margin;
        res[2] = &margin;
        CALL(step);
        if (margin < 0.0) CALL(step_beyond);
#else
        CALL(step);
#endif
        x = end;
        u = end + N_STATES;
    }
    if (!all_finite(x, N_STATES + N_INPUTS))
        return core_fail(instance, "%s is no longer finite after the step from t = %.17g s by %g s: "
                                   "the coupling or the micro step is unstable; take a smaller step",
                         first_lost(x, u), time, size);
    memcpy(s->x, x, N_STATES * sizeof *x);
    memcpy(inputs(s), u, N_INPUTS * sizeof *u);
    memset(s->rate, 0, sizeof s->rate);
    s->time = s->value[0] = time + size;
    s->outputs_stale = s->slopes_stale = 1;
    return OK;
}

Status core_plan(Instance *instance, double time, double size, long *count) {
    return plan(instance, time, size, count);
}

Status core_advance(Instance *instance, double time, double size, long count) {
    return advance(instance, time, size, count);
}

Status core_step(Instance *instance, double time, double size) {
    long count;
    return plan(instance, time, size, &count) == OK ? advance(instance, time, size, count) : ERROR;
}

int continuous_place(const uint32_t *table, uint32_t reference) {
    for (int i = 0; i < N_CONTINUOUS; i++)
        if (table[i] == reference) return i;
    return -1;
}

/* Whatever is asked for, along the seed. */
static Status along_seed(Instance *instance, const uint32_t *unknown, size_t unknown_count, const uint32_t *known,
                         size_t known_count, const double *seed, double *sensitivity) {
    State *s = &instance->state;
    double x_seed[N_CONTINUOUS + 1] = {0.0}, u_seed[N_INPUTS + 1] = {0.0};
    double fraction_seed[TABLE_STATIONS + 1], output[N_OUTPUTS + 1], rate[N_CONTINUOUS + 1];
    LISTS;
    for (size_t i = 0; i < known_count; i++) {
        int input = known[i] - FIRST_INPUT < N_INPUTS;
        int place = input ? (int)(known[i] - FIRST_INPUT) : continuous_place(STATE_REFERENCE, known[i]);
        if (place < 0)
            return core_fail(instance, "value reference %u is no input or continuous state to differentiate by",
                             (unsigned)known[i]);
        (input ? u_seed : x_seed)[place] += seed[i];
    }
    if (s->outputs_stale && refresh_lookup(instance) != OK) return ERROR;
    common_arguments(arg, s);
#if TABLE_STATIONS
    arg[4] = x_seed;
    arg[5] = u_seed;
    res[0] = fraction_seed;
    CALL(stations_forward);
    for (int i = 0; i < TABLE_STATIONS; i++) fraction_seed[i] /= TABLE_SPACING;
    common_arguments(arg, s);
#endif
    arg[4] = instance->lookup;
    arg[5] = x_seed;
    arg[6] = u_seed;
    arg[7] = fraction_seed;
    res[0] = output;
    res[1] = rate;
    CALL(forward);
    for (size_t i = 0; i < unknown_count; i++) {
        int is_output = unknown[i] - FIRST_OUTPUT < N_OUTPUTS;
        int place = is_output ? (int)(unknown[i] - FIRST_OUTPUT)
                              : continuous_place(DERIVATIVE_REFERENCE, unknown[i]);
        if (place < 0)
            return core_fail(instance, "value reference %u is no output or derivative to differentiate",
                             (unsigned)unknown[i]);
        sensitivity[i] = (is_output ? output : rate)[place];
    }
    return OK;
}

#if N_LED
static void refresh_slopes(Instance *instance) {
    State *s = &instance->state;
    LISTS;
    common_arguments(arg, s);
    arg[4] = instance->lookup;
    res[0] = instance->slope;
    CALL(slopes);
    s->slopes_stale = 0;
}

/* Slopes of the first outputs by inputs, which one evaluation gives for all calls; whether that is all
 * that is asked for. */
static inline int along_slopes(Instance *instance, const uint32_t *unknown, size_t unknown_count,
                               const uint32_t *known, size_t known_count, const double *seed,
                               double *sensitivity) {
    for (size_t k = 0; k < known_count; k++)
        if (known[k] - FIRST_INPUT >= N_INPUTS) return 0;
    for (size_t i = 0; i < unknown_count; i++) {
        uint32_t output = unknown[i] - FIRST_OUTPUT;
        if (output >= N_LED) return 0;
        if (instance->state.slopes_stale) refresh_slopes(instance);
        const double *slope = instance->slope + output * N_INPUTS;
        double sum = 0.0;
        for (size_t k = 0; k < known_count; k++) sum += slope[known[k] - FIRST_INPUT] * seed[k];
        sensitivity[i] = sum;
    }
    return 1;
}
#endif

Status core_directional(Instance *instance, const uint32_t *unknown, size_t unknown_count,
                        const uint32_t *known, size_t known_count, const double *seed,
                        double *sensitivity) {
    if (with_states(instance) != OK) return ERROR;
#if N_LED
    if (along_slopes(instance, unknown, unknown_count, known, known_count, seed, sensitivity)) return OK;
#endif
    return along_seed(instance, unknown, unknown_count, known, known_count, seed, sensitivity);
}
