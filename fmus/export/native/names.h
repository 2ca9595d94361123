/* Names for the linker. An importer that links several FMUs into one program defines a prefix for each,
 * as in FMI's headers: FMI2_FUNCTION_PREFIX=truck_ or FMI3_FUNCTION_PREFIX=truck_. The standard's
 * functions then have it, and with the version of FMI so has all that other files of the FMU call. */
#ifndef NAMES_H
#define NAMES_H

#define JOINED_(one, other) one##other
#define JOINED(one, other) JOINED_(one, other)

#if defined(FMI3_FUNCTION_PREFIX) && !defined(FMI3_OVERRIDE_FUNCTION_PREFIX)
#define FMI3_ACTUAL_FUNCTION_PREFIX FMI3_FUNCTION_PREFIX
#endif
#if defined(FMI2_FUNCTION_PREFIX)
#define PREFIX FMI2_FUNCTION_PREFIX
#define INTERNAL(name) JOINED(PREFIX, fmi2_##name)
#elif defined(FMI3_ACTUAL_FUNCTION_PREFIX)
#define PREFIX FMI3_ACTUAL_FUNCTION_PREFIX
#define INTERNAL(name) JOINED(PREFIX, fmi3_##name)
#else
#define PREFIX
#define INTERNAL(name) name
#endif

#define check_count INTERNAL(check_count)
#define continuous_place INTERNAL(continuous_place)
#define core_advance INTERNAL(core_advance)
#define core_check_state INTERNAL(core_check_state)
#define core_completed_step INTERNAL(core_completed_step)
#define core_create INTERNAL(core_create)
#define core_derivatives INTERNAL(core_derivatives)
#define core_directional INTERNAL(core_directional)
#define core_enter_continuous_mode INTERNAL(core_enter_continuous_mode)
#define core_enter_event_mode INTERNAL(core_enter_event_mode)
#define core_event_indicators INTERNAL(core_event_indicators)
#define core_fail INTERNAL(core_fail)
#define core_finish_initialization INTERNAL(core_finish_initialization)
#define core_free INTERNAL(core_free)
#define core_free_state INTERNAL(core_free_state)
#define core_get INTERNAL(core_get)
#define core_get_continuous_states INTERNAL(core_get_continuous_states)
#define core_get_kind INTERNAL(core_get_kind)
#define core_load INTERNAL(core_load)
#define core_new_discrete_states INTERNAL(core_new_discrete_states)
#define core_nominals INTERNAL(core_nominals)
#define core_pack INTERNAL(core_pack)
#define core_packed_size INTERNAL(core_packed_size)
#define core_plan INTERNAL(core_plan)
#define core_reset INTERNAL(core_reset)
#define core_restore INTERNAL(core_restore)
#define core_save INTERNAL(core_save)
#define core_set INTERNAL(core_set)
#define core_set_ahead INTERNAL(core_set_ahead)
#define core_set_continuous_states INTERNAL(core_set_continuous_states)
#define core_set_kind INTERNAL(core_set_kind)
#define core_set_rates INTERNAL(core_set_rates)
#define core_set_time INTERNAL(core_set_time)
#define core_start INTERNAL(core_start)
#define core_step INTERNAL(core_step)
#define core_terminate INTERNAL(core_terminate)
#define core_unpack INTERNAL(core_unpack)
#define elements INTERNAL(elements)
#define evaluate_constants INTERNAL(evaluate_constants)
#define evaluate_derivatives INTERNAL(evaluate_derivatives)
#define evaluate_indicators INTERNAL(evaluate_indicators)
#define first_lost INTERNAL(first_lost)
#define forget_caches INTERNAL(forget_caches)
#define refresh_outputs INTERNAL(refresh_outputs)
#define refresh_states INTERNAL(refresh_states)
#define release_equations INTERNAL(release_equations)
#define slave_clear INTERNAL(slave_clear)
#define slave_create INTERNAL(slave_create)
#define slave_deserialize INTERNAL(slave_deserialize)
#define slave_enter_initialization INTERNAL(slave_enter_initialization)
#define slave_exit_initialization INTERNAL(slave_exit_initialization)
#define slave_experiment INTERNAL(slave_experiment)
#define slave_free_state INTERNAL(slave_free_state)
#define slave_refuse INTERNAL(slave_refuse)
#define slave_reset INTERNAL(slave_reset)
#define slave_restore INTERNAL(slave_restore)
#define slave_save INTERNAL(slave_save)
#define slave_serialize INTERNAL(slave_serialize)
#define slave_serialized_size INTERNAL(slave_serialized_size)
#define update_memory INTERNAL(update_memory)
#define ARRAY_ELEMENT INTERNAL(ARRAY_ELEMENT)
#define ARRAY_START INTERNAL(ARRAY_START)
#define CALCULATED_NAME INTERNAL(CALCULATED_NAME)
#define DEPENDENCY INTERNAL(DEPENDENCY)
#define DEPENDENCY_START INTERNAL(DEPENDENCY_START)
#define DERIVATIVE_REFERENCE INTERNAL(DERIVATIVE_REFERENCE)
#define IN_ARRAY INTERNAL(IN_ARRAY)
#define REFERENCE INTERNAL(REFERENCE)
#define STATE_NAME INTERNAL(STATE_NAME)
#define STATE_NOMINAL INTERNAL(STATE_NOMINAL)
#define STATE_REFERENCE INTERNAL(STATE_REFERENCE)
#define VARIABLE_INFO INTERNAL(VARIABLE_INFO)

#endif
