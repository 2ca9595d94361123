"""Systems integrated as one: what is refused, loops, events that depend on one another."""

from __future__ import annotations

import zipfile
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from fmpy.fmi2 import FMU2Model
from fmpy.fmi3 import FMU3Model

import tolerances
from fmus.catalogue import fmu_path
from orchestrator import (
    Component,
    Connection,
    OrchestratorError,
    Port,
    PortMap,
    System,
    linearise,
    linearised,
    monolith,
    simulate,
)
from support.coupled_models import oscillator
from support.native_slaves import build_mass


def refusal(function, system: System, **options) -> str:
    with pytest.raises(OrchestratorError) as caught:
        function(system, **options)
    return str(caught.value)


def wheelsets(*connections: Connection, **values) -> System:
    components = {name: Component(fmu_path("wheelrail"), values) for name in "ab"}
    return System(components, connections)


LOOP = (Connection("a.force_y", "b.load_left"), Connection("b.force_y", "a.load_left"))


def test_who_offers_no_model_exchange_is_named(tmp_path):
    stepped = System({"mass": Component(build_mass(tmp_path)), "car": Component(fmu_path("truck"))})
    message = refusal(monolith, stepped, duration=1.0)
    assert message == (
        "the system cannot be integrated as one: mass (mass.fmu, FMI 2.0) offers no model exchange "
        "of FMI 2.0 or 3.0 for this machine; put an FMU there that does, or co-simulate"
    )
    assert "offers no model exchange" in refusal(linearise, oscillator())


@pytest.mark.parametrize("fmi", ["2.0", "3.0"])
def test_an_fmu_that_offers_model_exchange_alone_is_enough(tmp_path, fmi):
    whole = fmu_path("truck", fmi)
    lone = without_co_simulation(whole, tmp_path / "lone.fmu")
    values = {"axle[1].force_y": 2e4, "initial.warp_rate": 0.4}
    runs = [
        monolith(System({"truck": Component(fmu, values)}), duration=0.05) for fmu in (whole, lone)
    ]
    assert runs[1].completed, runs[1].message
    for name in runs[0].dataset:
        assert np.array_equal(runs[0].dataset[name], runs[1].dataset[name]), name
    slopes = [linearise(System({"truck": Component(fmu, values)})).a for fmu in (whole, lone)]
    assert np.array_equal(*slopes)
    message = refusal(simulate, System({"truck": Component(lone)}), duration=1.0)
    assert "offers model exchange only; an FMU for co-simulation is needed" in message


@pytest.mark.parametrize(
    ("fmi", "wrapper", "update"),
    [("2.0", FMU2Model, "newDiscreteStates"), ("3.0", FMU3Model, "updateDiscreteStates")],
)
def test_an_event_at_a_known_time_is_met_at_that_time(monkeypatch, fmi, wrapper, update):
    wanted, met, now = [0.01234, 0.03], [], [0.0]
    own_update, own_time, own_enter = (
        getattr(wrapper, name) for name in (update, "setTime", "enterEventMode")
    )

    def updated(fmu):
        later = [time for time in wanted if time > now[0]]
        return (*own_update(fmu)[:4], bool(later), later[0] if later else 0.0)

    def entered(fmu):
        met.append(now[0])
        return own_enter(fmu)

    def timed(fmu, time):
        now[0] = time
        return own_time(fmu, time)

    for name, function in ((update, updated), ("enterEventMode", entered), ("setTime", timed)):
        monkeypatch.setattr(wrapper, name, function)
    values = {"front.force_y": 2e4}
    run = monolith(System({"car": Component(fmu_path("carbody", fmi), values)}), duration=0.05)
    assert run.completed, run.message
    assert met == wanted
    assert np.isfinite(run.dataset["car.front.y"]).all()


def test_events_at_once_without_end_are_given_up(monkeypatch):
    own = FMU2Model.newDiscreteStates
    monkeypatch.setattr(FMU2Model, "newDiscreteStates", lambda fmu: (*own(fmu)[:4], True, 0.0))
    run = monolith(System({"car": Component(fmu_path("carbody"))}), duration=0.05)
    assert run.message == "stopped at t = 0 s: car indicates events without end"


def without_co_simulation(fmu: Path, target: Path) -> Path:
    with zipfile.ZipFile(fmu) as whole, zipfile.ZipFile(target, "w") as archive:
        for name in whole.namelist():
            content = whole.read(name)
            if name == "modelDescription.xml":
                description = ElementTree.fromstring(content)
                description.remove(description.find("CoSimulation"))
                content = ElementTree.tostring(description)
            archive.writestr(name, content)
    return target


def test_a_port_map_is_refused_by_the_instance_that_has_it():
    system = wheelsets().with_fmu("a", fmu_path("wheelrail"), PortMap({"y": Port("y", -1.0)}))
    message = refusal(linearise, system)
    assert message.startswith("the system cannot be integrated as one: a (wheelrail.fmu)")
    assert "map of its ports" in message


def test_an_algebraic_loop_is_refused_by_its_outputs():
    message = refusal(monolith, wheelsets(*LOOP, creep_law="polach"), duration=1.0)
    assert "it has the algebraic loop" in message
    assert "a.force_y" in message and "b.force_y" in message


def test_the_linear_model_solves_algebraic_loops():
    """Two equal wheelsets, the force of one the load of the other: slopes over 1 - g^2."""
    names = ["a.force_y", "b.force_y"]
    start = {"creep_law": "polach", "vy": -0.05, "load_right": 1e5}

    def slopes(*connections: Connection, **values):
        model = linearise(wheelsets(*connections, **start, **values), record=names)
        return model, dict(zip(model.inputs, model.d[0], strict=True))

    model, looped = slopes(*LOOP)
    assert model.outputs == tuple(names)
    _, alone = slopes(load_left=settled_load(start))
    gain = alone["a.load_left"]
    assert abs(gain) > 1e-3
    assert looped["a.y"] == pytest.approx(alone["a.y"] / (1 - gain**2), rel=tolerances.SETTLED)
    assert looped["b.y"] == pytest.approx(
        gain * alone["a.y"] / (1 - gain**2), rel=tolerances.SETTLED
    )


@pytest.mark.parametrize("fmi", ["2.0", "3.0"])
def test_the_linear_model_with_other_values_is_that_of_a_system_that_has_them(fmi):
    """An FMU of FMI 2.0 is reset for them, and one of 3.0 is loaded anew."""
    fmu = fmu_path("wheelrail", fmi)
    system = System({"b": Component(fmu, {"creep_law": "polach", "vy": -0.05})})
    with linearised(system, record="*.force_y") as model:
        found = [model({"b.conicity": taper}) for taper in (0.1, "0.2")] + [model({})]
        with pytest.raises(OrchestratorError, match="did you mean conicity"):
            model({"b.conicty": 0.1})
        with pytest.raises(OrchestratorError, match="there is no instance 'c'"):
            model({"c.conicity": 0.1})
    for taper, one in zip((0.1, 0.2, 0.05), found, strict=True):
        alone = linearise(system.with_value("b.conicity", taper), record="*.force_y")
        assert np.array_equal(one.d, alone.d)


def settled_load(start) -> float:
    """The force, and so the load, at which the loop is at rest."""
    from fmus import BLOCKS
    from fmus.describe.parameters import parameter_set
    from fmus.describe.twin import Twin

    block = BLOCKS["wheelrail"]()
    law = next(p.choices for p in block.parameters if p.name == "creep_law").index("polach") + 1
    twin = Twin(block, parameter_set("loaded").values(block) | {"creep_law": float(law)})
    for name in ("vy", "load_right"):
        twin.set(name, start[name])
    twin.initialize()
    load = 1.2e5
    for _ in range(200):
        twin.set("load_left", load)
        load = twin.get("force_y")
    return load


def test_a_system_without_states_is_recorded_all_the_same():
    run = monolith(wheelsets(y=1e-3), duration=0.01)
    assert run.completed
    assert np.ptp(run.dataset["a.force_y"].to_numpy()) == 0.0
    assert run.dataset["a.y_rel"].to_numpy() == pytest.approx(1e-3)


def test_a_run_that_fails_keeps_what_came_before():
    system = System({"truck": Component(fmu_path("truck"), {"axle[1].force_y": 1e300})})
    run = monolith(system, duration=1.0)
    assert not run.completed
    assert run.message.startswith("stopped at t = ")
    assert len(run.time) >= 1


def test_events_without_end_are_given_up_by_name():
    """At such a strain the margin of a slider is lost in rounding."""
    system = System({"truck": Component(fmu_path("truck"), {"axle[1].force_y": 1e30})})
    run = monolith(system, duration=1.0)
    assert run.message.endswith("truck indicates events without end")
