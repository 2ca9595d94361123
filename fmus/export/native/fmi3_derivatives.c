/* FMI 3.0: partial derivatives, and which variable depends on which. */
#include <stdlib.h>

#include "fmi3.h"

/* Both lists with arrays opened out, in one block of memory that the caller frees; NULL: none left. */
static uint32_t *opened(const fmi3ValueReference one[], size_t one_count, const fmi3ValueReference other[],
                        size_t other_count, size_t total) {
    uint32_t *open = malloc((total + 1) * sizeof *open), *next = open;
    for (size_t i = 0; open && i < one_count + other_count; i++) {
        const uint32_t *element;
        size_t size = elements(i < one_count ? one + i : other + (i - one_count), &element);
        for (size_t k = 0; k < size; k++) *next++ = element ? element[k] : EVENT_INDICATORS;
    }
    return open;
}

EXPORT(fmi3Status, fmi3GetDirectionalDerivative)(fmi3Instance c, const fmi3ValueReference unknown[],
                                                 size_t unknown_count, const fmi3ValueReference known[],
                                                 size_t known_count, const fmi3Float64 seed[], size_t seed_count,
                                                 fmi3Float64 sensitivity[], size_t sensitivity_count) {
    int scalar_unknown, scalar_known;
    NEEDS_INSTANCE;
    NEEDS_LISTS(unknown_count, unknown, sensitivity);
    NEEDS_LISTS(known_count, known, seed);
    NEEDS_READABLE;
    if (check_count(c, unknown, unknown_count, sensitivity_count, &scalar_unknown) != OK ||
        check_count(c, known, known_count, seed_count, &scalar_known) != OK)
        return ERROR;
    if (scalar_unknown && scalar_known)
        return core_directional(CORE, unknown, unknown_count, known, known_count, seed, sensitivity);
    uint32_t *open = opened(unknown, unknown_count, known, known_count, sensitivity_count + seed_count);
    if (!open) return slave_refuse(c, "not enough memory for the derivatives");
    Status status = core_directional(CORE, open, sensitivity_count, open + sensitivity_count, seed_count, seed,
                                     sensitivity);
    free(open);
    return status;
}

/* The transposed product, known by known: exact, at the price of one directional derivative each. */
EXPORT(fmi3Status, fmi3GetAdjointDerivative)(fmi3Instance c, const fmi3ValueReference unknown[],
                                             size_t unknown_count, const fmi3ValueReference known[],
                                             size_t known_count, const fmi3Float64 seed[], size_t seed_count,
                                             fmi3Float64 sensitivity[], size_t sensitivity_count) {
    int scalar;
    const double one = 1.0;
    NEEDS_INSTANCE;
    NEEDS_LISTS(unknown_count, unknown, seed);
    NEEDS_LISTS(known_count, known, sensitivity);
    NEEDS_READABLE;
    if (check_count(c, unknown, unknown_count, seed_count, &scalar) != OK ||
        check_count(c, known, known_count, sensitivity_count, &scalar) != OK)
        return ERROR;
    uint32_t *open = opened(unknown, unknown_count, known, known_count, seed_count + sensitivity_count);
    double *column = malloc((seed_count + 1) * sizeof *column);
    Status status = open && column ? OK : slave_refuse(c, "not enough memory for the derivatives");
    for (size_t k = 0; status == OK && k < sensitivity_count; k++) {
        status = core_directional(CORE, open, seed_count, open + seed_count + k, 1, &one, column);
        sensitivity[k] = 0.0;
        for (size_t i = 0; status == OK && i < seed_count; i++) sensitivity[k] += seed[i] * column[i];
    }
    free(column);
    free(open);
    return status;
}

static Status count_dependencies(Slave *c, fmi3ValueReference vr, size_t *count) {
    const uint32_t *element;
    int scalar;
    size_t size = elements(&vr, &element);
    if (!count) return slave_refuse(c, "a place for the number of dependencies is needed");
    if (check_count(c, &vr, 1, size, &scalar) != OK) return ERROR;
    *count = 0;
    for (size_t i = 0; i < size; i++) {
        if (!element || element[i] - FIRST_OUTPUT >= N_REFERENCES - FIRST_OUTPUT)
            return core_fail(CORE, "the dependencies of value reference %u are not told: it is no output and no "
                                   "derivative", (unsigned)vr);
        const uint32_t *first = DEPENDENCY_START + (element[i] - FIRST_OUTPUT);
        *count += first[1] - first[0];
    }
    return OK;
}

/* Of each element of the variable, in turn, the variables that it depends on directly. */
EXPORT(fmi3Status, fmi3GetNumberOfVariableDependencies)(fmi3Instance c, fmi3ValueReference vr, size_t *count) {
    NEEDS_INSTANCE;
    return count_dependencies(c, vr, count);
}

EXPORT(fmi3Status, fmi3GetVariableDependencies)(fmi3Instance c, fmi3ValueReference vr, size_t dependent_element[],
                                                fmi3ValueReference independent[], size_t independent_element[],
                                                fmi3DependencyKind kind[], size_t count) {
    const uint32_t *element;
    size_t known;
    NEEDS_INSTANCE;
    if (count_dependencies(c, vr, &known) != OK) return ERROR;
    NEEDS_LISTS(count, dependent_element && independent, independent_element && kind);
    if (count != known)
        return core_fail(CORE, "value reference %u has %u dependencies, and the call asks for %u", (unsigned)vr,
                         (unsigned)known, (unsigned)count);
    size_t size = elements(&vr, &element), next = 0;
    for (size_t i = 0; i < size; i++) {
        const uint32_t *first = DEPENDENCY_START + (element[i] - FIRST_OUTPUT);
        for (uint32_t k = first[0]; k < first[1]; k++, next++) {
            dependent_element[next] = i + 1;
            independent[next] = DEPENDENCY[k].variable;
            independent_element[next] = DEPENDENCY[k].element;
            kind[next] = fmi3Dependent;
        }
    }
    return OK;
}
