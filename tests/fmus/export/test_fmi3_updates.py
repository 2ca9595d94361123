"""FMI 3.0: inputs that vary within a macro step, set at intermediate updates."""

from __future__ import annotations

import numpy as np
import pytest

import tolerances
from fmus.catalogue import fmu_path
from support.excitation import STEP, scaled_inputs
from support.fmi3_instance import Fmi3Instance


class Asked(Fmi3Instance):
    """An instance that keeps what it is asked at intermediate updates, and answers by `reply`."""

    def __init__(self, block: str, early=False, required=(), reply=None) -> None:
        self.block, self.early, self.reply = block, early, reply
        self.asked: list[tuple] = []
        super().__init__(fmu_path(block, "3.0"))
        self.slave.freeInstance()
        self.required = self.vr(*required)

    def start(self) -> Asked:
        self.slave = type(self.slave)(
            kinds={},
            guid=self.description.guid,
            unzipDirectory=self.folder,
            modelIdentifier=self.block,
            instanceName="asked",
        )
        self.slave.instantiate(
            logMessage=self._log,
            intermediateUpdate=self.update,
            earlyReturnAllowed=self.early,
            requiredIntermediateVariables=self.required,
        )
        return self.initialize()

    def update(self, _env, time, setting, getting, finished, can_leave, leave, _until) -> None:
        self.asked.append((time, setting, getting, finished, can_leave))
        if self.reply:
            leave[0] = bool(self.reply(self, *self.asked[-1]))


@pytest.fixture
def asked():
    """Makes instances of Asked; all are closed when the test ends."""
    made = []

    def make(*arguments, **more):
        made.append(Asked(*arguments, **more).start())
        return made[-1]

    yield make
    for instance in made:
        instance.close()


@pytest.mark.parametrize("size", [STEP, 5 * STEP])
def test_inputs_linear_in_time_give_what_input_derivatives_give(instances, block_name, size):
    """Tangents included: what an input has taken of the block's own motion stays apart."""
    two, three = (instances(block_name, fmi).initialize() for fmi in ("2.0", "3.0"))
    names = two.names("input")
    rng = np.random.default_rng(7)
    rows = []
    at, then = (scaled_inputs(two, rng) for _ in range(2))
    for k in range(40):
        partials = {n: -rng.uniform(1e3, 1e5) for n in names if "_per_v" in n or "_per_w" in n}
        held = {n: 0.0 for n in names if "_per_" in n} | partials
        at, then = {**then, **held}, {**scaled_inputs(two, rng), **held}
        for each in (two, three):
            each.set(at)
            each.slave.setRealInputDerivatives(
                each.vr(*names), [1] * len(names), [(then[n] - at[n]) / size for n in names]
            )
            each.slave.doStep(k * size, size)
        rows.append([two.outputs() + two.get(*names), three.outputs() + three.get(*names)])
    one, other = np.swapaxes(rows, 0, 1)
    scale = np.abs(one).max(axis=0) + 1e-300
    assert np.abs((one - other) / scale).max() <= tolerances.INTERMEDIATE_UPDATE
    assert np.ptp(one, axis=0).max() > 0.0


def test_each_micro_step_asks_for_the_inputs_at_its_end(asked):
    truck = asked("truck")
    truck.slave.doStep(0.0, STEP)
    times = [time for time, setting, *_ in truck.asked if setting]
    assert times == pytest.approx([0.25 * STEP, 0.5 * STEP, 0.75 * STEP, STEP], rel=1e-14)
    assert times[-1] == STEP
    assert {tuple(flags) for _, *flags in truck.asked} == {(True, False, False, False)}


def test_what_is_not_set_is_held(asked, instances):
    one, other = asked("truck"), instances("truck", "2.0").initialize()
    for each in (one, other):
        each.set({"axle[1].force_y": 1e4})
        each.slave.doStep(0.0, STEP)
    assert one.outputs() == other.outputs()


def test_inputs_set_only_within_steps_go_on_from_there(asked):
    """A force that is told at updates alone moves the free body by its double integral."""
    rate, steps = 1e6, 10

    def push(carbody, time, setting, *_):
        if setting:
            force = 0.5 * rate * time
            carbody.slave.setFloat64(carbody.vr("front.force_z", "rear.force_z"), [force, force])

    carbody = asked("carbody", reply=push)
    for k in range(steps):
        carbody.slave.doStep(k * STEP, STEP)
    time = steps * STEP
    mass = carbody.get("body_mass")[0]
    assert carbody.get("cg.z")[0] == pytest.approx(rate * time**3 / (6 * mass), rel=1e-12)
    assert carbody.get("front.force_z")[0] == pytest.approx(0.5 * rate * time, rel=1e-12)


def test_outputs_can_be_read_after_each_micro_step(asked):
    seen = []

    def read(truck, time, _setting, getting, *_):
        if getting:
            seen.append(truck.get("axle[1].y")[0])

    truck = asked("truck", required=("axle[1].y",), reply=read)
    truck.set({"axle[1].force_y": 1e5})
    truck.slave.doStep(0.0, STEP)
    assert len(seen) == 4 and np.all(np.diff(np.abs(seen)) > 0.0)
    assert seen[-1] == truck.get("axle[1].y")[0]


def test_a_step_can_be_left_early_and_gone_on_with(asked):
    def leave_at_half(truck, time, _setting, _getting, finished, can_leave):
        return can_leave and finished and abs(time - 0.5 * STEP) < 1e-9

    left, whole = asked("truck", early=True, reply=leave_at_half), asked("truck")
    for each in (left, whole):
        each.set({"axle[1].force_y": 1e4})
    _, _, early, reached = left.slave.doStep(0.0, STEP)[:4]
    assert early and reached == pytest.approx(0.5 * STEP, rel=1e-14)
    _, _, early, reached = left.slave.doStep(reached, STEP - reached)
    assert not early and reached == STEP
    whole.slave.doStep(0.0, STEP)
    assert left.outputs() == pytest.approx(whole.outputs(), rel=1e-12, abs=1e-15)


def test_no_step_is_left_early_where_that_is_not_allowed(asked):
    truck = asked("truck", required=("axle[1].y",), reply=lambda *_: True)
    assert not truck.slave.doStep(0.0, STEP)[2]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda i: i.get("axle[1].y"), "nothing can be read"),
        (lambda i: i.slave.reset(), "intermediate update is under way"),
        (lambda i: i.slave.terminate(), "intermediate update is under way"),
        (lambda i: i.slave.getFMUState(), "intermediate update is under way"),
        (lambda i: i.set({"bolster_mass": 1e3}), "is no input: only inputs"),
        (lambda i: i.set({"car.y": float("nan")}), "finite number is needed"),
    ],
)
def test_before_a_micro_step_inputs_are_set_and_nothing_else(asked, call, message):
    said = []

    def misuse(truck, _time, setting, *_):
        if setting and not said:
            try:
                call(truck)
            except Exception:
                said.append(truck.messages[-1])

    truck = asked("truck", reply=misuse)
    truck.slave.doStep(0.0, STEP)
    assert message in said[0]


def test_after_a_micro_step_nothing_is_set(asked):
    said = []

    def misuse(truck, _time, _setting, getting, *_):
        if getting and not said:
            try:
                truck.set({"car.y": 1e-3})
            except Exception:
                said.append(truck.messages[-1])

    truck = asked("truck", required=("axle[1].y",), reply=misuse)
    truck.slave.doStep(0.0, STEP)
    assert "this one is finished" in said[0]


def test_a_step_of_zero_length_asks_for_nothing(asked, block_name):
    instance = asked(block_name)
    instance.slave.doStep(0.0, 0.0)
    assert instance.asked == []
