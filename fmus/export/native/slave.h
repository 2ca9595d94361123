/* What FMI 2.0 and FMI 3.0 share above the core: the instance's name, the experiment's times, the
 * order of the calls around a run, saved states and their bytes. */
#ifndef SLAVE_H
#define SLAVE_H

#include <math.h>

#include "core.h"
#include "visible.h"

/* Begins a function of the standard. */
#define EXPORT(type, name) VISIBLE type JOINED(PREFIX, name)

typedef struct {
    Instance *core;
    char *name;
    double start, stop;
} Slave;

/* Fills the slave, its name first, for the log; NULL, or why there can be no such instance: `problem`,
 * if the caller knows of one. */
const char *slave_create(Slave *slave, Interface interface, const char *name, const char *token,
                         Report report, void *environment, const char *problem);
void slave_clear(Slave *slave);

/* ERROR, after the message has been logged; a slave that is not there has no log. */
Status slave_refuse(Slave *slave, const char *what);

Status slave_experiment(Slave *slave, double start, int stop_defined, double stop);
Status slave_enter_initialization(Slave *slave);
Status slave_exit_initialization(Slave *slave);
Status slave_reset(Slave *slave);

/* Whether a step goes on from where the instance is, and stays within the experiment. */
static inline Status slave_check_step(Slave *slave, double time, double size) {
    double stop = slave->stop, now = slave->core->state.time;
    int possible = slave->core->state.phase == STEPPING && size >= 0.0 && isfinite(time + size);
    if (possible && fabs(time - now) > 1e-9 * fabs(now) + 1e-6 * size) /* what masters lose by rounding */
        return core_fail(slave->core, "doStep from t = %.17g s by %g s, and this instance is at t = %.17g s: step "
                                      "from there, or restore a state that was saved at the other time",
                         time, size, now);
    if (time + size > stop + 1e-9 * fabs(stop) + 1e-6 * size)
        return core_fail(slave->core, "doStep from t = %.17g s by %g s goes past the stop time of %g s", time,
                         size, stop);
    return OK;
}

Status slave_save(Slave *slave, void **state);
Status slave_restore(Slave *slave, const void *state);
Status slave_free_state(Slave *slave, void **state);
Status slave_serialized_size(Slave *slave, const void *state, size_t *size);
Status slave_serialize(Slave *slave, const void *state, void *bytes, size_t size);
Status slave_deserialize(Slave *slave, const void *bytes, size_t size, void **state);

#define NEEDS_INSTANCE if (!c) return ERROR
#define NEEDS_LISTS(count, one, other) \
    if ((count) != 0 && (!(one) || !(other))) return slave_refuse(c, "a list of the call is missing: it is NULL")
#define NEEDS_SETTABLE                               \
    if (((Slave *)c)->core->state.phase == TERMINATED) \
    return slave_refuse(c, "the run has ended: a reset or a saved state comes before new values")

#endif
