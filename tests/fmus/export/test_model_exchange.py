"""Model exchange: an integrator that knows nothing of the blocks finds their motion and events."""

from __future__ import annotations

import ctypes

import numpy as np
import pytest
from fmpy import simulate_fmu
from fmpy.fmi1 import FMICallException

import tolerances
from fmus import BLOCKS
from fmus.catalogue import fmu_path
from fmus.describe.parameters import parameter_set
from fmus.describe.twin import Twin
from fmus.truck.ports import ELEMENTS
from support.excitation import march, scaled_inputs

IMMOVABLE = 1e12
"""Factor on the truck's inertias with which a prescribed motion of the carbody moves it not."""


def integrate(block: str, duration: float, **more):
    """Results of FMPy's CVode; with `record_events` an event has a row before and one after it."""
    return simulate_fmu(
        str(fmu_path(block)),
        fmi_type="ModelExchange",
        solver="CVode",
        stop_time=duration,
        relative_tolerance=more.pop("relative_tolerance", 1e-9),
        **more,
    )


def values_of(block: str) -> dict[str, float]:
    return parameter_set("loaded").values(BLOCKS[block]())


def heavy(**more: float) -> dict[str, float]:
    values = values_of("truck")
    inertias = {n: v for n, v in values.items() if n.endswith(("_mass", "_inertia"))}
    return {n: IMMOVABLE * v for n, v in inertias.items()} | more


def event_times(result) -> np.ndarray:
    """Instants that were recorded twice, before and after an event."""
    return np.unique(result["time"][1:][np.diff(result["time"]) == 0.0])


def test_carbody_integrated_is_its_exact_step():
    start = {"initial.torsion": 5.0, "initial.roll_rate": 0.02, "initial.yaw": 1e-3}
    forces = {"front.force_y": 2e4, "rear.moment_x": -1e4}
    result = integrate("carbody", 1.0, start_values=start | forces, output_interval=0.05)
    twin = Twin(BLOCKS["carbody"](), values_of("carbody") | start)
    for name, value in forces.items():
        twin.set(name, value)
    twin.initialize()
    twin.step(1.0)
    for name in ("q[1]", "q[3]", "q[4]", "q[6]", "q[7]", "qd[6]", "front.y", "front.ay"):
        assert result[name][-1] == pytest.approx(twin.get(name), rel=tolerances.EXCHANGE), name


def test_distance_is_speed_times_time_and_brings_the_rails_along(instantiate2):
    result = integrate("track", 2.0, start_values={"speed": 31.0}, output_interval=0.5)
    assert result["distance"] == pytest.approx(31.0 * result["time"], rel=tolerances.EXCHANGE)
    stepped = instantiate2("track").initialize()
    stepped.set({"speed": 31.0})
    stepped.slave.doStep(0.0, 2.0)
    for name in ("axle[1].rail_y_left", "axle[4].rail_y_right"):
        assert result[name][-1] == pytest.approx(stepped.get(name)[0], rel=tolerances.EXCHANGE)


def sinusoid(amplitude: float, frequency: float, duration: float) -> np.ndarray:
    """The carbody's lateral motion and its rate, fine enough to be linear in between."""
    time = np.linspace(0.0, duration, 20001)
    phase = 2 * np.pi * frequency * time
    signals = np.zeros(len(time), [(n, "f8") for n in ("time", "car.y", "car.vy")])
    signals["time"], signals["car.y"] = time, amplitude * np.sin(phase)
    signals["car.vy"] = 2 * np.pi * frequency * amplitude * np.cos(phase)
    return signals


AMPLITUDE, FREQUENCY, CYCLES = 3e-3, 1.0, 2


@pytest.fixture(scope="module")
def loop():
    """The centre plate's lateral element under a carbody that moves to and fro."""
    return integrate(
        "truck",
        CYCLES / FREQUENCY,
        start_values=heavy(),
        input=sinusoid(AMPLITUDE, FREQUENCY, CYCLES / FREQUENCY),
        output=["car.force_y", "friction[1]", "slip[1]"],
        output_interval=1e-3,
        record_events=True,
    )


def test_jenkins_loop_dissipates_4f_times_slip(loop):
    values = values_of("truck")
    limit = values["centre_plate_lateral.friction_limit"]
    reach = limit / values["centre_plate_lateral.friction_stiffness"]
    cycle = loop[loop["time"] >= (CYCLES - 1) / FREQUENCY]
    motion = AMPLITUDE * np.sin(2 * np.pi * FREQUENCY * cycle["time"])
    force = cycle["friction[1]"]  # on the carbody, which moves
    dissipated = -np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(motion))
    expected = 4 * limit * (AMPLITUDE - reach)
    assert dissipated == pytest.approx(expected, rel=tolerances.JENKINS_LOOP)


def test_sliders_give_way_and_turn_at_the_instants_of_the_closed_form(loop):
    """Events are few: each slip has a beginning, a turn, and the step after it."""
    values = values_of("truck")
    reach = (
        values["centre_plate_lateral.friction_limit"]
        / values["centre_plate_lateral.friction_stiffness"]
    )
    first = np.arcsin(reach / AMPLITUDE)
    later = np.arcsin(1 - 2 * reach / AMPLITUDE)  # after a turn twice the reach is stuck
    turns = np.pi / 2 + np.pi * np.arange(2 * CYCLES)
    begins = np.append(first, turns[:-1] + np.pi / 2 - later)
    expected = np.sort(np.append(turns, begins)) / (2 * np.pi * FREQUENCY)
    found = event_times(loop)
    for instant in expected:
        # Inputs that are linear in pieces are rough where the strain turns.
        assert np.abs(found - instant).min() < 1e-4, instant
    assert len(found) <= len(expected) + 2 * CYCLES


def test_a_slider_gives_way_when_its_strain_is_the_reach():
    rate = 0.05
    values = values_of("truck")
    reach = values["warp.friction_limit"] / values["warp.friction_stiffness"]
    result = integrate(
        "truck",
        0.06,
        start_values=heavy(**{"initial.warp_rate": rate}),
        output=["friction[6]", "q[4]", "slip[6]"],
        output_interval=1e-3,
        record_events=True,
    )
    centre_plate = (
        values["centre_plate_lateral.friction_limit"]
        / values["centre_plate_lateral.friction_stiffness"]
        / values["half_wheelbase"]  # warp takes the centre plate along
    )
    angles = [reach, centre_plate, values["warp.free_play"]]
    expected = [angle / rate for angle in angles]
    assert event_times(result) == pytest.approx(expected, abs=tolerances.EVENT_INSTANT)
    end = result[-1]
    assert end["slip[6]"] == pytest.approx(end["q[4]"] - reach, rel=tolerances.EXCHANGE)


def test_a_truck_that_slips_moves_as_under_micro_steps(instantiate2):
    kick = {"initial.warp_rate": 0.4, "initial.bolster_lateral_rate": 0.5, "initial.yaw_rate": 0.1}
    restoring = {"car.y": 1e-3}
    duration, names = 0.3, [f"{kind}[{i}]" for kind in ("q", "qd") for i in (1, 2, 4, 5)]
    result = integrate(
        "truck", duration, start_values=kick | restoring, output=names, output_interval=1e-3
    )
    truck = instantiate2("truck")
    truck.set(restoring)
    truck.initialize(kick | {"micro_step": 5e-6})
    rows = [truck.get(*names)]
    slipped = False
    steps = round(duration / 1e-3)
    for k in range(steps):
        truck.slave.doStep(k * 1e-3, 1e-3)
        rows.append(truck.get(*names))
        slipped |= any(truck.get(*(f"slip[{i}]" for i in range(1, 7))))
    assert slipped
    regular = [np.abs(result["time"] - k * 1e-3).argmin() for k in range(steps + 1)]
    for name, expected in zip(names, np.transpose(rows), strict=True):
        scale = np.abs(expected).max()
        assert (
            np.abs(result[name][regular] - expected).max() < tolerances.EXCHANGE_FRICTION * scale
        ), name


def test_a_flange_is_an_event_at_its_clearance():
    clearance = values_of("wheelrail")["flange_clearance"]
    speed, signals = 0.02, np.zeros(2, [("time", "f8"), ("y", "f8")])
    signals["time"], signals["y"] = [0.0, 1.0], [0.0, speed]
    result = integrate(
        "wheelrail",
        1.0,
        input=signals,
        output=["y_rel", "force_y"],
        output_interval=0.05,
        record_events=True,
    )
    (instant,) = event_times(result)
    assert instant == pytest.approx(clearance / speed, abs=tolerances.EVENT_INSTANT)


def exchange(instantiate2, block_name, name="instance"):
    """An instance in event mode, after some motion of states and inputs."""
    instance = instantiate2(block_name, name, model_exchange=True)
    instance.initialize()
    return instance


def state_sizes(instance) -> np.ndarray:
    """A plausible size of each continuous state."""
    names = [unknown.variable.derivative.name for unknown in instance.description.derivatives]
    return np.array([2e-3 if name.startswith("q[") else 0.05 for name in names])


def test_directional_derivatives_agree_with_differences_by_states_and_inputs(
    instantiate2, block_name
):
    instance = exchange(instantiate2, block_name)
    rng = np.random.default_rng(11)
    march(instance, 5, 1)
    instance.slave.enterContinuousTimeMode()
    derivatives = [unknown.variable for unknown in instance.description.derivatives]
    states = [v.derivative.name for v in derivatives]
    base = dict(zip(states, state_sizes(instance) * rng.uniform(-1, 1, len(states)), strict=True))
    base |= scaled_inputs(instance, rng)
    unknowns = [*instance.names("output"), *(v.name for v in derivatives)]

    def at(point):
        instance.set({n: v for n, v in point.items() if n not in states})
        instance.set_states([point[n] for n in states])
        return np.array(instance.get(*unknowns))

    for name in base:
        nudge = 1e-6 * max(abs(base[name]), 1e-3)
        low, high = (at(base | {name: base[name] + s * nudge}) for s in (-1, 1))
        size = np.abs(at(base)).max()
        exact = np.array(
            instance.slave.getDirectionalDerivative(
                instance.vr(*unknowns), instance.vr(name), [1.0]
            )
        )
        scale = np.abs(exact).max() + size * 1e-9 / nudge
        assert np.abs(exact - (high - low) / (2 * nudge)).max() <= 1e-5 * scale + 1e-12, name


def test_unknowns_move_only_with_the_states_they_declare(instantiate2, block_name):
    instance = exchange(instantiate2, block_name)
    march(instance, 5, 1)
    instance.slave.enterContinuousTimeMode()
    declared = {
        unknown.variable.name: {v.name for v in unknown.dependencies}
        for unknown in (*instance.description.outputs, *instance.description.derivatives)
    }
    unknowns = list(declared)
    states = [u.variable.derivative.name for u in instance.description.derivatives]
    base = np.array(instance.states())
    before = np.array(instance.get(*unknowns))
    for i, name in enumerate(states):
        moved = base.copy()
        moved[i] += 0.3 * state_sizes(instance)[i]
        instance.set_states(moved)
        changed = before != instance.get(*unknowns)
        found = {u for u, moves in zip(unknowns, changed, strict=True) if moves}
        assert found, name
        assert found <= {u for u in unknowns if name in declared[u]}, name


def test_derivative_variables_are_the_derivatives(instantiate2, block_name):
    instance = exchange(instantiate2, block_name)
    march(instance, 5, 1)
    names = [unknown.variable.name for unknown in instance.description.derivatives]
    assert instance.get(*names) == instance.derivatives()


def test_states_are_the_outputs_of_their_names(instantiate2, block_name):
    instance = exchange(instantiate2, block_name)
    march(instance, 5, 1)
    names = [unknown.variable.derivative.name for unknown in instance.description.derivatives]
    assert instance.get(*names) == instance.states()


@pytest.mark.parametrize("in_bytes", [False, True])
def test_a_saved_state_brings_back_memory_and_modes(instantiate2, block_name, in_bytes):
    one, other = (exchange(instantiate2, block_name, name) for name in ("one", "other"))
    march(one, 30, 2)
    state = one.slave.getFMUstate()
    expected = march(one, 30, 3)
    if in_bytes:
        state = other.slave.deSerializeFMUstate(one.slave.serializeFMUstate(state))
    else:
        other = one
    other.slave.setFMUstate(state)
    assert march(other, 30, 3) == expected


def test_a_state_of_co_simulation_does_not_go_on_in_model_exchange(instantiate2, block_name):
    stepped = instantiate2(block_name, "stepped").initialize()
    model = exchange(instantiate2, block_name)
    for one, other, saying in (
        (stepped, model, "a state of co-simulation cannot go on in an instance for model exchange"),
        (model, stepped, "a state of model exchange cannot go on in an instance for co-simulation"),
    ):
        state = one.slave.getFMUstate()
        with pytest.raises(FMICallException):
            other.slave.setFMUstate(state)
        assert other.messages[-1] == saying


def refused(instance, function, *arguments) -> str:
    with pytest.raises(FMICallException):
        function(*arguments)
    return instance.messages[-1]


def test_each_mode_refuses_the_calls_of_another(instantiate2, block_name):
    instance = instantiate2(block_name, model_exchange=True)
    slave = instance.slave
    for call in (instance.derivatives, instance.states, instance.indicators):
        if instance.state_count:
            assert "the instance is not yet in initialization" in refused(instance, call)
    assert "needs event mode" in refused(instance, slave.newDiscreteStates)
    instance.initialize()
    for function, arguments in (
        (slave.enterEventMode, ()),
        (slave.completedIntegratorStep, ()),
        (instance.set_states, ([0.0] * instance.state_count,)),
    ):
        message = refused(instance, function, *arguments)
        assert message.endswith("needs continuous-time mode; the instance is in event mode")
    assert "is for co-simulation" in refused(instance, instance.stepped.doStep, 0.0, 1e-3)
    port = instance.vr(instance.names("input")[0])
    message = refused(instance, instance.stepped.setRealInputDerivatives, port, [1], [0.0])
    assert "input derivatives are for co-simulation" in message
    slave.enterContinuousTimeMode()
    for function in (slave.newDiscreteStates, slave.enterContinuousTimeMode):
        message = refused(instance, function)
        assert message.endswith("needs event mode; the instance is in continuous-time mode")
    assert "the time cannot be nan" in refused(instance, slave.setTime, float("nan"))
    slave.terminate()
    assert "the instance is terminated" in refused(instance, slave.setTime, 0.0)


def test_states_of_another_number_or_without_one_are_refused(instantiate2):
    truck = exchange(instantiate2, "truck")
    truck.slave.enterContinuousTimeMode()
    message = refused(truck, truck.set_states, [0.0] * 18)
    assert message == "there are 12 continuous states, and 18 were asked for"
    message = refused(truck, truck.set_states, [0.0] * 11 + [float("nan")])
    assert message == "the state qd[6] cannot be nan: a finite number is needed"


def test_parameters_are_tuned_at_events(instantiate2):
    truck = exchange(instantiate2, "truck")
    stiffness = {"warp.stiffness": 1e6}
    truck.set(stiffness)
    truck.slave.enterContinuousTimeMode()
    message = refused(truck, truck.set, stiffness)
    assert message == "warp.stiffness is a parameter: in model exchange it is set in event mode"


def test_an_instance_for_co_simulation_refuses_model_exchange(instantiate2, block_name):
    stepped = instantiate2(block_name).initialize()
    library, component = stepped.slave.dll, ctypes.c_void_p(stepped.slave.component)
    assert library.fmi2EnterEventMode(component) == 3
    assert stepped.messages[-1] == (
        "entering event mode is for model exchange, and this instance for co-simulation"
    )


def test_no_event_follows_at_once_on_an_event(instantiate2):
    """What a slider's event sets up is away from zero, whichever way the strain then goes."""
    truck = exchange(instantiate2, "truck")
    values = values_of("truck")
    reach = [values[f"{n}.friction_limit"] / values[f"{n}.friction_stiffness"] for n in ELEMENTS]
    truck.slave.enterContinuousTimeMode()
    for sign in (1, -1):
        strain = np.zeros(12)
        strain[[4, 3]] = sign * 1.5 * np.array(reach)[[4, 5]]
        strain[[10, 9]] = sign * 0.1
        truck.set_states(strain)
        assert min(truck.indicators()[4:6]) < 0
        truck.slave.enterEventMode()
        truck.slave.newDiscreteStates()
        assert min(truck.indicators()[4:6]) > 1e-3  # slipping on
        truck.slave.enterContinuousTimeMode()
        strain[[10, 9]] *= -1
        truck.set_states(strain)
        assert max(truck.indicators()[4:6]) < 0  # turned
        strain[[4, 3]] *= 0.9
        truck.set_states(strain)
        event, _ = truck.slave.completedIntegratorStep()
        assert event
        assert min(truck.indicators()[4:6]) > 1e-6 * min(reach)  # stuck
        event, _ = truck.slave.completedIntegratorStep()
        assert not event


def test_twin_has_the_same_derivatives_indicators_and_memory(instantiate2, block_name):
    instance = exchange(instantiate2, block_name)
    twin = Twin(BLOCKS[block_name](), values_of(block_name))
    twin.initialize()
    rng = np.random.default_rng(4)
    instance.slave.enterContinuousTimeMode()
    for _ in range(20):
        inputs = scaled_inputs(instance, rng)
        states = state_sizes(instance) * rng.uniform(-1, 1, instance.state_count)
        instance.set(inputs)
        instance.set_states(states)
        for name, value in inputs.items():
            twin.set(name, value)
        twin.x[: len(states)] = states
        for ours, theirs in (
            (instance.derivatives(), twin.derivatives()),
            (instance.indicators(), twin.event_indicators()),
        ):
            scale = np.abs(theirs).max(initial=1e-9)
            assert np.allclose(ours, theirs, rtol=tolerances.PARITY, atol=tolerances.PARITY * scale)
        instance.slave.completedIntegratorStep()
        twin.update_memory()
        assert np.allclose(instance.outputs(), twin.outputs(), rtol=1e-9, atol=1e-6)
